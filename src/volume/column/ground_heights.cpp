#include "ground_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tetropolis/ground/surfaces.h"

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

/// Levels the vertices of each region of water.
void level_water(const GroundMesh& mesh, std::vector<double>& terrain) {
  IndexedVector<RegionIndex, std::int8_t> is_water;
  for (const Region& region : mesh.regions)
    is_water.push_back(mesh.patches.of(region.floor).name == name_of(SurfaceKind::kWater));
  if (std::find(is_water.begin(), is_water.end(), 1) == is_water.end()) return;
  std::vector<std::uint8_t> has_land(mesh.vertices.size(), 0);
  IndexedVector<RegionIndex, std::vector<VertexIndex>> vertices(mesh.regions.size());
  for (const TriangleIndex t : mesh.triangles.indices())
    for (const VertexIndex v : mesh.triangles[t])
      if (const RegionIndex r = mesh.region[t]; is_water[r] != 0)
        vertices[r].push_back(v);
      else
        has_land[v] = 1;
  for (std::vector<VertexIndex>& own : vertices) {
    sort_once(own);
    std::vector<double> rim, all;
    for (const VertexIndex v : own) {
      all.push_back(terrain[v]);
      if (has_land[v] != 0) rim.push_back(terrain[v]);
    }
    std::vector<double>& heights = rim.empty() ? all : rim;
    if (heights.empty()) continue;
    const double level = median(heights);
    for (const VertexIndex v : own) terrain[v] = level;
  }
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

std::vector<double> lifted_terrain(const GroundMesh& mesh, const Raster& dtm,
                                   std::span<const double> lift) {
  std::vector<double> terrain = terrain_under(mesh, dtm);
  for (const VertexIndex v : indices<VertexIndex>(lift.size())) terrain[v] += lift[v];
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
