#include "lid.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "volume/layered/free_top.h"

namespace tetropolis {

namespace {

// Found by trial, by the least angles and the numbers of cells.

/// Spacings between the highest floor and the lid.
constexpr double kAboveFloors = 2;

/// Tangent of the lid's slope, at most.
constexpr double kSteepestLid = 0.6;

/// Where fewer spacings than these are left above the lid, columns go on to the top;
constexpr double kBelowTop = 1;
/// around such places the lid falls from the top with this tangent, as long as so many are left.
constexpr double kSteepestFall = 1, kLeastBelowTop = 0.6;

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
  const auto reach_top = [&](double least) {
    for (const VertexIndex v : mesh.vertices.indices())
      if (lid[v] + least * plan.spacing[v] > plan.top[v]) lid[v] = plan.top[v];
  };
  reach_top(kBelowTop);
  limit_slope(mesh, edges, kSteepestFall, lid);
  reach_top(kLeastBelowTop);
  plan.top = std::move(lid);
}

}  // namespace tetropolis
