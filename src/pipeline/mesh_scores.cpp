#include "mesh_scores.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "tetropolis/city/roof_summary.h"

#include "geometry/vec2.h"

namespace tetropolis {

namespace {

constexpr double kEnough = 10;

CellScore score_of(std::vector<double> cells) {
  CellScore score;
  score.count = static_cast<std::int64_t>(cells.size());
  if (cells.empty()) return score;
  std::sort(cells.begin(), cells.end());
  score.least = cells.front();
  score.median = cells[(cells.size() - 1) / 2];
  const auto enough = std::lower_bound(cells.begin(), cells.end(), kEnough);
  score.share_of_ten =
      static_cast<double>(cells.end() - enough) / static_cast<double>(cells.size());
  return score;
}

std::vector<double> cells_of_buildings(const CityModel& city, const GroundMesh& ground) {
  std::vector<double> length(city.buildings.size(), 0), edges(city.buildings.size(), 0);
  for (const TaggedEdge& edge : ground.tagged_edges) {
    if (edge.region == kNoRegion || !ground.regions[edge.region].is_building()) continue;
    const BuildingIndex b = ground.regions[edge.region].building;
    length[b] += distance(ground.vertices[edge.low], ground.vertices[edge.high]);
    edges[b] += 1;
  }
  std::vector<double> cells;
  for (const BuildingIndex b : city.buildings.indices()) {
    if (length[b] > 0)
      cells.push_back(std::cbrt(volume_of(city.buildings[b])) * edges[b] / length[b]);
  }
  return cells;
}

/// From where, and by how many edges, the front of a building has come to a vertex.
struct Front {
  BuildingIndex building = kNoBuilding;
  VertexIndex wall = kNoVertex;
  std::int32_t edges = 0;
};

struct Gap {
  double width = 0;
  std::int32_t edges = 0;
};

std::vector<double> cells_of_gaps(const ColumnMesh& mesh, double street) {
  const GroundMesh& ground = mesh.ground;
  IndexedVector<VertexIndex, Front> fronts(ground.vertices.size());
  std::vector<VertexIndex> row;
  for (const VertexIndex v : ground.vertices.indices())
    for (const RegionIndex r : mesh.regions[v])
      if (ground.regions[r].is_building() && fronts[v].building == kNoBuilding) {
        fronts[v] = {ground.regions[r].building, v, 0};
        row.push_back(v);
      }
  const auto is_open = [&](EdgeIndex e) {
    const auto& beside = mesh.edges.triangles[e];
    return std::any_of(beside.begin(), beside.end(), [&](TriangleIndex t) {
      return t != kNoTriangle && !ground.inside_building(t);
    });
  };
  const auto spread = [&](EdgeIndex e, VertexIndex from, VertexIndex to) {
    if (fronts[to].building != kNoBuilding || !is_open(e)) return;
    fronts[to] = {fronts[from].building, fronts[from].wall, fronts[from].edges + 1};
    row.push_back(to);
  };
  for (std::size_t next = 0; next < row.size(); ++next) {
    const VertexIndex v = row[next];
    for (const EdgeIndex e : mesh.edges.ends[v]) spread(e, v, mesh.edges.vertices[e][0]);
    for (const EdgeIndex e : mesh.edges.starting_at(v)) spread(e, v, mesh.edges.vertices[e][1]);
  }
  std::map<std::pair<BuildingIndex, BuildingIndex>, Gap> gaps;
  for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
    const EdgeIndex e(i);
    const Front& a = fronts[mesh.edges.vertices[e][0]];
    const Front& b = fronts[mesh.edges.vertices[e][1]];
    if (a.building == b.building || a.building == kNoBuilding || b.building == kNoBuilding ||
        !is_open(e))
      continue;
    const Gap gap{distance(ground.vertices[a.wall], ground.vertices[b.wall]),
                  a.edges + b.edges + 1};
    const auto [known, is_new] =
        gaps.try_emplace({std::min(a.building, b.building), std::max(a.building, b.building)}, gap);
    if (!is_new && gap.width < known->second.width) known->second = gap;
  }
  std::vector<double> cells;
  for (const auto& [pair, gap] : gaps)
    if (gap.width >= street) cells.push_back(gap.edges);
  return cells;
}

}  // namespace

ResolutionFacts score_resolution(const CityModel& city, const ColumnMesh& mesh) {
  return {score_of(cells_of_buildings(city, mesh.ground)),
          score_of(cells_of_gaps(mesh, kStreetWidth))};
}

}  // namespace tetropolis
