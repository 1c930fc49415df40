#include "improve_prisms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "volume/quality/prism_shape.h"

namespace tetropolis {

namespace {

constexpr double kDegreesPerSkewness = 5;  // what both are weighed by
constexpr double kLeastShare = 0.4;        // of a segment's height
constexpr int kMostRounds = 60;
/// Of the room up or down; tried in this order.
constexpr std::array kSteps{0.4, -0.4, 0.15, -0.15, 0.04, -0.04};

double squared(double excess) { return excess > 0 ? excess * excess : 0; }

double penalty_across(const PrismFace& face, const Point3& from, const Point3& to,
                      const PrismAims& aims) {
  const double angle = to_degrees(std::acos(std::min(cosine_across(face, from, to), 1.0)));
  return squared(angle - aims.non_orthogonal_deg) +
         squared(kDegreesPerSkewness * (skewness_across(face, from, to) - aims.skewness));
}

/// Of all faces of a prism.
double penalty(const ColumnMesh& mesh, TriangleIndex t, std::int32_t layer, const PrismAims& aims) {
  const Prism prism = prism_at(mesh, t, layer);
  double sum = 0;
  const auto add = [&](std::size_t face, TriangleIndex other, std::int32_t beside) {
    const PrismFace& of = prism.faces[face];
    if (other != kNoTriangle && beside >= 0 && beside < prism_count(mesh, other))
      sum += penalty_across(of, prism.centre, prism_at(mesh, other, beside).centre, aims);
    else
      sum +=
          squared(kDegreesPerSkewness * (skewness_at_boundary(of, prism.centre) - aims.skewness));
  };
  add(0, t, layer - 1);
  add(1, t, layer + 1);
  for (std::size_t i = 0; i < 3; ++i) {
    const TriangleIndex other = triangle_beyond(mesh, t, i);
    add(2 + i, other,
        other == kNoTriangle ? -1
                             : layer + prisms_above(mesh, t, other, mesh.ground.triangles[t][i]));
  }
  return sum;
}

struct FreeNode {
  VertexIndex vertex;
  NodeIndex node;
  double least_below, least_above;  ///< Of the segments it is between, metres.

  bool operator<(const FreeNode& other) const { return node < other.node; }
  bool operator==(const FreeNode& other) const { return node == other.node; }
};

/// Those of faults, and next to them in their columns.
std::vector<FreeNode> nodes_of_faults(const ColumnMesh& mesh, const PrismAims& aims) {
  std::vector<std::vector<FreeNode>> found(mesh.triangle_count());
  parallel_chunks(mesh.triangle_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
      for (std::int32_t layer = 0; layer < prism_count(mesh, t); ++layer) {
        if (!(penalty(mesh, t, layer, aims) > 0)) continue;
        for (const VertexIndex v : mesh.ground.triangles[t]) {
          const std::int64_t below = mesh.floor_over(t, v) - mesh.first[v] + layer -
                                     (mesh.has_layers(t) ? mesh.layers.count : 0);
          const auto floors = mesh.floors_at(v);
          for (std::int64_t at = std::max<std::int64_t>(below - 1, 1);
               at <= below + 2 && mesh.first[v] + at < mesh.top(v); ++at) {
            if (std::find(floors.begin(), floors.end(), at) != floors.end()) continue;
            const NodeIndex n = mesh.first[v] + at;
            found[t].push_back({v, n, kLeastShare * (mesh.z[n] - mesh.z[n - 1]),
                                kLeastShare * (mesh.z[n + 1] - mesh.z[n])});
          }
        }
      }
  });
  std::vector<FreeNode> nodes;
  for (const auto& own : found) nodes.insert(nodes.end(), own.begin(), own.end());
  sort_once(nodes);
  return nodes;
}

/// Of the prisms that have the node.
double penalty_around(const ColumnMesh& mesh, std::span<const TriangleIndex> around,
                      const FreeNode& node, const PrismAims& aims) {
  double sum = 0;
  for (const TriangleIndex t : around) {
    const auto above = static_cast<std::int32_t>(node.node - mesh.floor_over(t, node.vertex)) +
                       (mesh.has_layers(t) ? mesh.layers.count : 0);
    for (const std::int32_t layer : {above - 1, above})
      if (layer >= 0 && layer < prism_count(mesh, t)) sum += penalty(mesh, t, layer, aims);
  }
  return sum;
}

/// Whether a step was found that helps.
bool move(ColumnMesh& mesh, std::span<const TriangleIndex> around, const FreeNode& node,
          const PrismAims& aims) {
  const double before = penalty_around(mesh, around, node, aims);
  if (!(before > 0)) return false;
  double& z = mesh.z[node.node];
  const double was = z, up = mesh.z[node.node + 1] - node.least_above - was;
  const double down = was - mesh.z[node.node - 1] - node.least_below;
  for (const double step : kSteps) {
    const double room = step > 0 ? up : down;
    if (!(room > 0)) continue;
    z = was + step * room;
    if (penalty_around(mesh, around, node, aims) < 0.995 * before) return true;
  }
  z = was;
  return false;
}

}  // namespace

std::int64_t improve_prisms(ColumnMesh& mesh, const PrismAims& aims) {
  const std::vector<FreeNode> nodes = nodes_of_faults(mesh, aims);
  std::vector<int> moved_in(mesh.vertex_count(), 0);  // per vertex, the last round; 0: never
  bool again = true;
  for (int round = 1; again && round <= kMostRounds; ++round) {
    again = false;
    for (const FreeNode& node : nodes) {
      const std::array vertex{node.vertex};
      const std::vector<TriangleIndex> around = triangles_around(mesh.edges, vertex);
      const auto is_new = [&](TriangleIndex t) {
        const auto& v = mesh.ground.triangles[t];
        return std::any_of(v.begin(), v.end(),
                           [&](VertexIndex u) { return moved_in[u] >= round - 1; });
      };
      if (round > 1 && std::none_of(around.begin(), around.end(), is_new)) continue;
      if (!move(mesh, around, node, aims)) continue;
      moved_in[node.vertex] = round;
      again = true;
    }
  }
  return std::ssize(moved_in) - std::count(moved_in.begin(), moved_in.end(), 0);
}

}  // namespace tetropolis
