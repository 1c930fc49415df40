#include "ground_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

#include "tetropolis/ground/surfaces.h"

#include "core/disjoint_sets.h"
#include "core/infinity.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "geometry/vec2.h"
#include "layers_at_walls.h"

namespace tetropolis {

std::vector<RegionIndex> lowest_roofs(const GroundMesh& mesh, const RoofHeights& roofs) {
  std::vector<RegionIndex> lowest(mesh.vertices.size(), kNoRegion);
  for (const TriangleIndex t : mesh.triangles.indices()) {
    if (!mesh.inside_building(t)) continue;
    const RegionIndex own = mesh.region[t];
    for (const VertexIndex v : mesh.triangles[t]) {
      const auto height = [&](RegionIndex r) { return roofs.at(r, v); };
      RegionIndex& least = lowest[v];
      if (least == kNoRegion || std::pair(height(own), own) < std::pair(height(least), least))
        least = own;
    }
  }
  return lowest;
}

std::vector<std::uint8_t> outside_vertices(const GroundMesh& mesh) {
  std::vector<std::uint8_t> outside(mesh.vertices.size(), 0);
  for (const TriangleIndex t : mesh.triangles.indices())
    if (!mesh.inside_building(t))
      for (const VertexIndex v : mesh.triangles[t]) outside[v] = 1;
  return outside;
}

double longest_wall_edge(const Raster& dtm, const RoofPlane& roof, Point2 a, Point2 b,
                         double minimum_wall, double layers) {
  // Found by trial, on the survey's cities below the floor of quality and on random hillsides.
  constexpr double kEdgesPerHeight = 4, kEdgesPerDepth = 3, kLeastHeight = 1, kGentle = 0.25;
  const double length = distance(a, b);
  const double steps = std::ceil(std::max(1.0, length / dtm.step));
  double lowest = kInfinity, highest = -kInfinity;
  double least = kInfinity;  // of the part where the ground stays
  for (double i = 0; i <= steps; ++i) {
    const double t = i / steps;
    const Point2 p{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    const double height = roof(p) - sample(dtm, p);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    if (height >= minimum_wall) least = std::min(least, height);
  }
  if (layers > 0 && least < kInfinity) least -= layers_beside_wall(layers, least);
  if (lowest < minimum_wall && highest - lowest > kGentle * length) return kInfinity;
  return std::max(kEdgesPerHeight * std::max(least, kLeastHeight), kEdgesPerDepth * -lowest);
}

namespace {

/// Levels the vertices of each piece of water: of triangles that have edges in common.
void level_water(const GroundMesh& mesh, std::vector<double>& terrain) {
  IndexedVector<RegionIndex, std::int8_t> is_water;
  for (const Region& region : mesh.regions)
    is_water.push_back(mesh.patches.of(region.floor).name == name_of(SurfaceKind::kWater));
  if (std::find(is_water.begin(), is_water.end(), 1) == is_water.end()) return;
  std::vector<std::uint8_t> has_land(mesh.vertices.size(), 0);
  std::vector<TriangleIndex> water;
  std::vector<std::tuple<VertexIndex, VertexIndex, std::size_t>> edges;  // of water[i]
  for (const TriangleIndex t : mesh.triangles.indices()) {
    const std::array<VertexIndex, 3>& corners = mesh.triangles[t];
    if (is_water[mesh.region[t]] == 0) {
      for (const VertexIndex v : corners) has_land[v] = 1;
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
      edges.emplace_back(low, high, water.size());
    }
    water.push_back(t);
  }
  std::sort(edges.begin(), edges.end());
  DisjointSets<std::size_t> pieces(water.size());
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const auto& [low, high, w] = edges[i - 1];
    const auto& [next_low, next_high, next] = edges[i];
    if (low == next_low && high == next_high) pieces.join(w, next);
  }
  std::map<std::size_t, std::vector<VertexIndex>> vertices;
  for (std::size_t w = 0; w < water.size(); ++w)
    for (const VertexIndex v : mesh.triangles[water[w]]) vertices[pieces.root(w)].push_back(v);
  std::vector<double> levels(mesh.vertices.size(), kInfinity);
  for (auto& [root, own] : vertices) {
    sort_once(own);
    std::vector<double> rim, all;
    for (const VertexIndex v : own) {
      all.push_back(terrain[v]);
      if (has_land[v] != 0) rim.push_back(terrain[v]);
    }
    const double level = median(rim.empty() ? all : rim);
    for (const VertexIndex v : own) levels[v] = std::min(levels[v], level);
  }
  for (const VertexIndex v : mesh.vertices.indices())
    if (levels[v] < kInfinity) terrain[v] = levels[v];
}

}  // namespace

std::vector<double> terrain_under(const GroundMesh& mesh, const Raster& dtm) {
  std::vector<double> terrain(mesh.vertices.size());
  parallel_chunks(mesh.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end))
      terrain[v] = sample(dtm, mesh.vertices[v]);
  });
  level_water(mesh, terrain);
  return terrain;
}

void lower_at_walls(const GroundMesh& mesh, std::span<const RegionIndex> lowest_roof,
                    const RoofHeights& roofs, std::span<const double> least,
                    std::span<const double> wall, std::vector<double>& ground) {
  for (const VertexIndex v : mesh.vertices.indices()) {
    if (lowest_roof[v] == kNoRegion) continue;
    const double roof = roofs.at(lowest_roof[v], v);
    if (ground[v] > roof - least[v]) ground[v] = std::min(ground[v], roof - wall[v]);
  }
}

}  // namespace tetropolis
