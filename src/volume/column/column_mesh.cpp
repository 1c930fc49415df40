#include "tetropolis/volume/column/column_mesh.h"

#include <algorithm>
#include <limits>
#include <string>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

[[noreturn]] void throw_invalid(std::size_t v, const char* what) {
  throw Error(ErrorKind::kGuarantee,
              "column mesh: at ground vertex " + std::to_string(v) + " " + what);
}

double shortest_edge(const ColumnMesh& mesh, std::size_t v) {
  const auto first = static_cast<std::size_t>(mesh.first[v]);
  const auto end = static_cast<std::size_t>(mesh.first[v + 1]);
  if (end < first + 2) throw_invalid(v, "the column has no height");
  double shortest = kInfinity;
  for (std::size_t n = first; n + 1 < end; ++n) {
    const double length = mesh.z[n + 1] - mesh.z[n];
    // Written so that NaN and infinity fail as well.
    if (!(length > 0 && length < kInfinity)) throw_invalid(v, "the column does not increase");
    shortest = std::min(shortest, length);
  }
  return shortest;
}

void require_flat_roofs(const ColumnMesh& mesh) {
  std::vector<double> roofs(mesh.ground.regions.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.inside_building(t)) continue;
    double& roof = roofs[static_cast<std::size_t>(mesh.ground.region[t])];
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      const double z = mesh.z[static_cast<std::size_t>(mesh.floor_over(t, v))];
      if (roof != roof) roof = z;
      if (z != roof) throw_invalid(static_cast<std::size_t>(v), "the roof is not horizontal");
    }
  }
}

}  // namespace

std::vector<NodeIndex> cell_offsets(const ColumnMesh& mesh) {
  std::vector<NodeIndex> offsets(mesh.triangle_count() + 1, 0);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    offsets[t + 1] = offsets[t];
    for (const VertexIndex v : mesh.ground.triangles[t])
      offsets[t + 1] += mesh.top(v) - mesh.floor_over(t, v);
  }
  return offsets;
}

double require_valid(const ColumnMesh& mesh) {
  require_flat_roofs(mesh);
  return parallel_reduce_ordered(
      mesh.vertex_count(), 4096, kInfinity,
      [&](std::size_t begin, std::size_t end) {
        double shortest = kInfinity;
        for (std::size_t v = begin; v < end; ++v)
          shortest = std::min(shortest, shortest_edge(mesh, v));
        return shortest;
      },
      [](double a, double b) { return std::min(a, b); });
}

}  // namespace tetropolis
