#include "improve_prisms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/infinity.h"
#include "core/is_among.h"
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
/// Nodes above go along, each by this share of the one below, where a node alone finds no step.
constexpr double kFollow = 0.75;
constexpr std::int64_t kMostFollowers = 8;

double squared(double excess) { return excess > 0 ? excess * excess : 0; }

double penalty_across(const PrismFace& face, const Point3& from, const Point3& to,
                      const PrismAims& aims) {
  const double angle = to_degrees(std::acos(std::min(cosine_across(face, from, to), 1.0)));
  return squared(angle - aims.non_orthogonal_deg) +
         squared(kDegreesPerSkewness * (skewness_across(face, from, to) - aims.skewness));
}

/// Of all faces of a prism. prism_of(t, layer) is any prism of the mesh.
template <typename PrismOf>
double penalty(const ColumnMesh& mesh, TriangleIndex t, std::int32_t layer, const PrismAims& aims,
               const PrismOf& prism_of) {
  const Prism prism = prism_of(t, layer);
  double sum = 0;
  const auto add = [&](std::size_t face, TriangleIndex other, std::int32_t beside) {
    const PrismFace& of = prism.faces[face];
    if (other != kNoTriangle && beside >= 0 && beside < prism_count(mesh, other))
      sum += penalty_across(of, prism.centre, prism_of(other, beside).centre, aims);
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
  NodeIndex end;  ///< Of the floor above, or the top.

  bool operator<(const FreeNode& other) const { return node < other.node; }
  bool operator==(const FreeNode& other) const { return node == other.node; }
};

/// Those of faults, and next to them in their columns.
std::vector<FreeNode> nodes_of_faults(const ColumnMesh& mesh, const PrismAims& aims) {
  const auto prism_of = [&](TriangleIndex t, std::int32_t layer) {
    return prism_at(mesh, t, layer);
  };
  std::vector<std::vector<FreeNode>> found(mesh.triangle_count());
  parallel_chunks(mesh.triangle_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
      for (std::int32_t layer = 0; layer < prism_count(mesh, t); ++layer) {
        if (!(penalty(mesh, t, layer, aims, prism_of) > 0)) continue;
        for (const VertexIndex v : mesh.ground.triangles[t]) {
          const std::int64_t below = mesh.floor_over(t, v) - mesh.first[v] + layer -
                                     (mesh.has_layers(t) ? mesh.layers.count : 0);
          const auto floors = mesh.floors_at(v);
          for (std::int64_t at = std::max<std::int64_t>(below - 1, 1);
               at <= below + 2 && mesh.first[v] + at < mesh.top(v); ++at) {
            if (std::find(floors.begin(), floors.end(), at) != floors.end()) continue;
            NodeIndex last = mesh.top(v);
            for (const std::int32_t floor : floors)
              if (floor > at) last = std::min(last, mesh.first[v] + floor);
            found[t].push_back({v, mesh.first[v] + at, last});
          }
        }
      }
  });
  std::vector<FreeNode> nodes;
  for (const auto& own : found) nodes.insert(nodes.end(), own.begin(), own.end());
  sort_once(nodes);
  return nodes;
}

class Improving {
 public:
  Improving(ColumnMesh& mesh, const PrismAims& aims) : mesh_(mesh), before_(mesh.z), aims_(aims) {}

  /// Whether a step was found that helps.
  bool move(std::span<const TriangleIndex> around, const FreeNode& node) {
    known_.clear();
    if (!(penalty_around(around, node, 1) > 0)) return false;
    if (move(around, node, 1)) return true;
    const std::int64_t followers = std::min(node.end - node.node, kMostFollowers);
    return followers > 1 && move(around, node, followers);
  }

 private:
  /// Of the prisms that have one of `count` nodes from this one on.
  double penalty_around(std::span<const TriangleIndex> around, const FreeNode& node,
                        std::int64_t count);
  const Prism& prism_of(TriangleIndex t, std::int32_t layer);
  void forget(std::span<const TriangleIndex> triangles);
  bool move(std::span<const TriangleIndex> around, const FreeNode& node, std::int64_t count);
  /// Of the segment above node n until it is as short as it may become, metres.
  double spare(NodeIndex n) const {
    return mesh_.z[n + 1] - mesh_.z[n] - kLeastShare * (before_[n + 1] - before_[n]);
  }

  ColumnMesh& mesh_;
  const std::vector<double> before_;
  const PrismAims& aims_;
  /// Prisms around the node at hand: each has a part in the faces of five others.
  struct Known {
    TriangleIndex triangle;
    std::vector<std::pair<std::int32_t, Prism>> prisms;  ///< By layer.
  };
  std::vector<Known> known_;
};

/// Valid until the next call.
const Prism& Improving::prism_of(TriangleIndex t, std::int32_t layer) {
  auto known =
      std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.triangle == t; });
  if (known == known_.end()) known = known_.insert(known, {t, {}});
  for (const auto& [at, prism] : known->prisms)
    if (at == layer) return prism;
  return known->prisms.emplace_back(layer, prism_at(mesh_, t, layer)).second;
}

void Improving::forget(std::span<const TriangleIndex> triangles) {
  for (Known& known : known_)
    if (is_among(known.triangle, triangles)) known.prisms.clear();
}

double Improving::penalty_around(std::span<const TriangleIndex> around, const FreeNode& node,
                                 std::int64_t count) {
  const auto prism = [&](TriangleIndex t, std::int32_t layer) -> const Prism& {
    return prism_of(t, layer);
  };
  double sum = 0;
  for (const TriangleIndex t : around) {
    const auto above = static_cast<std::int32_t>(node.node - mesh_.floor_over(t, node.vertex)) +
                       (mesh_.has_layers(t) ? mesh_.layers.count : 0);
    const auto end = std::min<std::int64_t>(above + count, prism_count(mesh_, t));
    for (std::int32_t layer = std::max(above - 1, 0); layer < end; ++layer)
      sum += penalty(mesh_, t, layer, aims_, prism);
  }
  return sum;
}

bool Improving::move(std::span<const TriangleIndex> around, const FreeNode& node,
                     std::int64_t count) {
  const double before = penalty_around(around, node, count);
  std::array<double, kMostFollowers> was{}, share{};
  double up = kInfinity;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    was[at] = mesh_.z[node.node + i];
    share[at] = i == 0 ? 1 : kFollow * share[at - 1];
    up = std::min(up, spare(node.node + i) / (share[at] * (i + 1 < count ? 1 - kFollow : 1)));
  }
  const double down = spare(node.node - 1);
  const auto shift = [&](double by) {
    for (std::int64_t i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      mesh_.z[node.node + i] = was[at] + by * share[at];
    }
    forget(around);
  };
  for (const double step : kSteps) {
    const double room = step > 0 ? up : down;
    if (!(room > 0)) continue;
    shift(step * room);
    if (penalty_around(around, node, count) < 0.995 * before) return true;
  }
  shift(0);
  return false;
}

}  // namespace

std::int64_t improve_prisms(ColumnMesh& mesh, const PrismAims& aims) {
  const std::vector<FreeNode> nodes = nodes_of_faults(mesh, aims);
  Improving improving(mesh, aims);
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
      if (!improving.move(around, node)) continue;
      moved_in[node.vertex] = round;
      again = true;
    }
  }
  return std::ssize(moved_in) - std::count(moved_in.begin(), moved_in.end(), 0);
}

}  // namespace tetropolis
