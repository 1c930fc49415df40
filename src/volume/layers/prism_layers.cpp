#include "prism_layers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "tetropolis/core/error.h"

#include "core/parallel.h"
#include "volume/column/layers_at_walls.h"
#include "volume/layered/free_top.h"

namespace tetropolis {

namespace {

/// Tangent of the angle between ground and top of the layers, at most.
constexpr double kSteepestLift = 0.25;

double sum_of(const LayerHeights& heights, double ratio) {
  return LayerHeights{heights.count, heights.first, ratio}.total();
}

/// Tops of the layers above the ground, without the uppermost one, which is at `all`. Where even
/// layers that shrink upwards leave too little for the first, all are alike: the uppermost is as
/// high as can be, and faces above it lean the less.
void divide_layers(double all, const LayerHeights& heights, std::vector<double>& tops) {
  double low = 1 / heights.growth, high = heights.growth;
  double first = heights.first;
  if (all < sum_of(heights, low)) {
    first = all / heights.count;
    high = 1;
  } else if (all < sum_of(heights, high)) {
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (sum_of(heights, middle) < all ? low : high) = middle;
    }
  }
  tops.clear();
  double top = 0;
  for (int i = 0; i + 1 < heights.count; ++i, first *= high) tops.push_back(top += first);
}

void number_prisms(ColumnMesh& mesh) {
  PrismLayers& layers = mesh.layers;
  layers.offsets.assign(mesh.triangle_count() + 1, 0);
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const VertexIndex v = mesh.ground.triangles[t][0];
    layers.offsets[t + 1] = layers.offsets[t] + (mesh.has_layers(t) ? layers.count : 0) +
                            (layers.whole ? mesh.top(v) - mesh.floor_over(t, v) : 0);
  }
}

}  // namespace

std::vector<double> layer_lift(const GroundMesh& mesh, const EdgeGraph& edges,
                               std::span<const double> terrain,
                               std::span<const RegionIndex> lowest_roof, const RoofHeights& roofs,
                               const LayerHeights& heights, double minimum_wall, double left) {
  if (heights.count == 0) return {};
  const double all = heights.total();
  std::vector<double> lift(mesh.vertices.size(),
                           -all);  // downwards, as slopes are limited by raising
  for (const VertexIndex v : mesh.vertices.indices()) {
    if (lowest_roof[v] == kNoRegion) continue;
    const double wall = roofs.at(lowest_roof[v], v) - terrain[v];
    lift[v] = -layers_beside_wall(all, std::max(wall, minimum_wall), left);
  }
  limit_slope(mesh, edges, kSteepestLift, lift);
  for (double& height : lift) height = -height;
  return lift;
}

void lay_prisms(std::span<const double> lift, const LayerHeights& heights, ColumnMesh& mesh) {
  PrismLayers layers;
  layers.count = heights.count;
  layers.position.assign(mesh.vertex_count(), -1);
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (mesh.inside_building(t)) continue;
    for (const VertexIndex v : mesh.ground.triangles[t]) layers.position[v] = 0;
  }
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    if (layers.position[v] < 0) continue;
    layers.position[v] = static_cast<std::int32_t>(layers.vertices.size());
    layers.vertices.push_back(v);
  }
  const auto count = static_cast<std::size_t>(layers.count);
  layers.z.resize(layers.vertices.size() * count);
  parallel_chunks(layers.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::vector<double> tops;
    for (std::size_t i = begin; i < end; ++i) {
      const VertexIndex v = layers.vertices[i];
      const double ground = mesh.z[mesh.first[v]] - lift[v];
      divide_layers(lift[v], heights, tops);
      double* z = layers.z.data() + i * count;
      *z++ = ground;
      for (const double top : tops) *z++ = ground + top;
    }
  });
  mesh.layers = std::move(layers);
  number_prisms(mesh);
}

void make_whole(ColumnMesh& mesh) {
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const auto& v = mesh.ground.triangles[t];
    const auto segments = [&](std::size_t i) { return mesh.top(v[i]) - mesh.floor_over(t, v[i]); };
    if (segments(0) != segments(1) || segments(0) != segments(2))
      throw Error(ErrorKind::kGuarantee, "prisms: the columns at ground vertex " +
                                             std::to_string(v[0]) + " and beside it differ");
  }
  mesh.layers.whole = true;
  number_prisms(mesh);
}

}  // namespace tetropolis
