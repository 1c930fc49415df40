#include "lid.h"

#include <algorithm>
#include <vector>

#include "volume/layered/free_top.h"

namespace tetropolis {

namespace {

// Found by trial, by the least angles and the numbers of cells.

/// Spacings between the highest floor and the lid, and between the lid and the top at least.
constexpr double kAboveFloors = 1.5, kBelowTop = 2;

/// Tangent of the lid's slope, at most.
constexpr double kSteepestLid = 0.6;

}  // namespace

void lower_tops(const GroundMesh& mesh, const EdgeGraph& edges, ColumnPlan& plan) {
  std::vector<double> lid(mesh.vertices.size());
  const auto raise = [&](VertexIndex v, double floor) {
    lid[v] = std::max(lid[v], floor + kAboveFloors * plan.spacing[v]);
  };
  for (const VertexIndex v : mesh.vertices.indices()) lid[v] = plan.ground[v];
  for (const TriangleIndex t : mesh.triangles.indices())
    for (const VertexIndex v : mesh.triangles[t]) raise(v, plan.floor(mesh, mesh.region[t], v));
  limit_slope(mesh, edges, kSteepestLid, lid);
  for (const VertexIndex v : mesh.vertices.indices())
    if (lid[v] + kBelowTop * plan.spacing[v] < plan.top[v]) plan.top[v] = lid[v];
}

}  // namespace tetropolis
