#include "tetropolis/volume/column/column_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "levels.h"
#include "upper_faces.h"

namespace tetropolis {

namespace {

[[noreturn]] void throw_invalid(VertexIndex v, const char* what) {
  throw Error(ErrorKind::kGuarantee,
              "column mesh: at ground vertex " + std::to_string(v) + " " + what);
}

/// Of the layers.
double shortest_below(const ColumnMesh& mesh, VertexIndex v) {
  const PrismLayers& layers = mesh.layers;
  if (layers.count == 0 || layers.position[v] < 0) return kInfinity;
  const auto count = static_cast<std::size_t>(layers.count);
  const double* const z = layers.z.data() + static_cast<std::size_t>(layers.position[v]) * count;
  double shortest = kInfinity;
  for (std::size_t k = 0; k < count; ++k) {
    const double length = (k + 1 < count ? z[k + 1] : mesh.z[mesh.first[v]]) - z[k];
    if (!(length > 0 && length < kInfinity)) throw_invalid(v, "the layers do not increase");
    shortest = std::min(shortest, length);
  }
  return shortest;
}

double shortest_edge(const ColumnMesh& mesh, VertexIndex v) {
  const NodeIndex first = mesh.first[v], end = mesh.first[v + 1];
  if (end < first + 2) throw_invalid(v, "the column has no height");
  double shortest = shortest_below(mesh, v);
  for (const NodeIndex n : indices(first, end - 1)) {
    const double length = mesh.z[n + 1] - mesh.z[n];
    // Written so that NaN and infinity fail as well.
    if (!(length > 0 && length < kInfinity)) throw_invalid(v, "the column does not increase");
    shortest = std::min(shortest, length);
  }
  return shortest;
}

void require_flat_roofs(const ColumnMesh& mesh) {
  std::vector<double> roofs(mesh.ground.regions.size(), std::numeric_limits<double>::quiet_NaN());
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (!mesh.inside_building(t)) continue;
    double& roof = roofs[mesh.ground.region[t]];
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      const double z = mesh.z[mesh.floor_over(t, v)];
      if (roof != roof) roof = z;
      if (z != roof) throw_invalid(v, "the roof is not horizontal");
    }
  }
}

void require_passed_roofs(const ColumnMesh& mesh) {
  for (const EdgeIndex e : mesh.edges.vertices.indices())
    if (!passes(mesh, e))
      throw_invalid(mesh.edges.vertices[e][0], "fronts do not pass through the roof's edge");
}

/// Of the upper part.
double shortest_upper_edge(const ColumnMesh& mesh) {
  const UpperMesh& upper = mesh.upper;
  const auto shortest_of = [&](std::size_t f) {
    const UpperFan& fan = upper.fans[f];
    if (!fan.up.valid()) return kInfinity;
    const double length = upper_position(mesh, fan.up)[2] - upper_position(mesh, fan.node)[2];
    if (!(length > 0 && length < kInfinity))
      throw_invalid(upper_vertex(mesh, fan.node), "the column does not increase");
    return length;
  };
  return parallel_reduce_ordered(
      upper.fans.size() - 1, 4096, kInfinity,
      [&](std::size_t begin, std::size_t end) {
        double shortest = kInfinity;
        for (std::size_t f = begin; f < end; ++f) shortest = std::min(shortest, shortest_of(f));
        return shortest;
      },
      [](double a, double b) { return std::min(a, b); });
}

}  // namespace

std::vector<CellIndex> cell_offsets(const ColumnMesh& mesh) {
  std::vector<CellIndex> offsets(mesh.triangle_count() + 1);
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    offsets[t + 1] = offsets[t];
    if (mesh.layers.whole) continue;
    for (const VertexIndex v : mesh.ground.triangles[t])
      offsets[t + 1] += mesh.top(v) - mesh.floor_over(t, v);
  }
  for (std::size_t left = mesh.upper.cells(); left > 0;) {
    const std::size_t block = std::min(left, kUpperBlock);
    offsets.push_back(offsets.back() + block);
    left -= block;
  }
  return offsets;
}

double require_valid(const ColumnMesh& mesh) {
  if (mesh.levels.empty())
    require_flat_roofs(mesh);
  else
    require_passed_roofs(mesh);
  const double of_upper = mesh.upper.empty() ? kInfinity : shortest_upper_edge(mesh);
  return parallel_reduce_ordered(
      mesh.vertex_count(), 4096, of_upper,
      [&](std::size_t begin, std::size_t end) {
        double shortest = kInfinity;
        for (const VertexIndex v : indices<VertexIndex>(begin, end))
          shortest = std::min(shortest, shortest_edge(mesh, v));
        return shortest;
      },
      [](double a, double b) { return std::min(a, b); });
}

}  // namespace tetropolis
