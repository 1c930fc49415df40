#include "improve_prisms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/infinity.h"
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

/// What a face is beyond the aims by.
class Penalty {
 public:
  explicit Penalty(const PrismAims& aims)
      : aims_(aims), least_cosine_(std::cos(to_radians(aims.non_orthogonal_deg))) {}
  /// Between the cells with these centres; the face's area leaves the first.
  double inner(const PrismFace& face, const Point3& from, const Point3& to) const {
    const double cosine = cosine_across(face, from, to);
    const double excess =
        cosine < least_cosine_ ? to_degrees(std::acos(cosine)) - aims_.non_orthogonal_deg : 0;
    return squared(excess) + of_skewness(skewness_across(face, from, to));
  }
  double outer(const PrismFace& face, const Point3& from) const {
    return of_skewness(skewness_at_boundary(face, from));
  }

 private:
  double of_skewness(double skewness) const {
    return squared(kDegreesPerSkewness * (skewness - aims_.skewness));
  }

  PrismAims aims_;
  double least_cosine_;
};

/// Calls use(layer, sum) for prisms [begin, end) of a stack: the sum over the faces of each.
template <typename Use>
void for_each_penalty(const PrismSurroundings& around, std::int32_t begin, std::int32_t end,
                      const Penalty& penalty, const Use& use) {
  const PrismStack& stack = around.stack();
  Prism prism = stack.prism(begin);
  Point3 below{};
  if (begin > 0) below = stack.centre(begin - 1);
  for (std::int32_t layer = begin; layer < end; ++layer) {
    const Point3& own = prism.centre;
    double sum =
        layer > 0 ? penalty.inner(prism.faces[0], own, below) : penalty.outer(prism.faces[0], own);
    for (std::size_t i = 0; i < 3; ++i)
      sum += around.has_beyond(i, layer)
                 ? penalty.inner(prism.faces[2 + i], own, around.centre_beyond(i, layer))
                 : penalty.outer(prism.faces[2 + i], own);
    if (layer + 1 == stack.count()) {
      use(layer, sum + penalty.outer(prism.faces[1], own));
      return;
    }
    const Prism above = stack.prism(layer + 1);
    use(layer, sum + penalty.inner(prism.faces[1], own, above.centre));
    below = own;
    prism = above;
  }
}

struct FreeNode {
  VertexIndex vertex;
  NodeIndex node;
  NodeIndex end;  ///< Of the floor above, or the top.

  bool operator<(const FreeNode& other) const { return node < other.node; }
  bool operator==(const FreeNode& other) const { return node == other.node; }
};

/// Those of faults, and next to them in their columns.
std::vector<FreeNode> nodes_of_faults(const ColumnMesh& mesh, const Penalty& penalty) {
  std::vector<std::vector<FreeNode>> found(mesh.triangle_count());
  parallel_chunks(mesh.triangle_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end)) {
      const auto add = [&](std::int32_t layer, double sum) {
        if (!(sum > 0)) return;
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
      };
      for_each_penalty(PrismSurroundings(mesh, t), 0, prism_count(mesh, t), penalty, add);
    }
  });
  std::vector<FreeNode> nodes;
  for (const auto& own : found) nodes.insert(nodes.end(), own.begin(), own.end());
  sort_once(nodes);
  return nodes;
}

class Improving {
 public:
  Improving(ColumnMesh& mesh, const Penalty& penalty)
      : mesh_(mesh), before_(mesh.z), penalty_(penalty) {}

  /// Whether a step was found that helps.
  bool move(std::span<const TriangleIndex> around, const FreeNode& node) {
    stacks_.clear();
    for (const TriangleIndex t : around)
      stacks_.push_back({{mesh_, t},
                         static_cast<std::int32_t>(node.node - mesh_.floor_over(t, node.vertex)) +
                             (mesh_.has_layers(t) ? mesh_.layers.count : 0)});
    if (!(penalty_around(1) > 0)) return false;
    if (move(node, 1)) return true;
    const std::int64_t followers = std::min(node.end - node.node, kMostFollowers);
    return followers > 1 && move(node, followers);
  }

 private:
  /// Of the prisms that have one of `count` nodes from the one at hand on, or `most` or more.
  double penalty_around(std::int64_t count, double most = kInfinity) const;
  bool move(const FreeNode& node, std::int64_t count);
  /// Of the segment above node n until it is as short as it may become, metres.
  double spare(NodeIndex n) const {
    return mesh_.z[n + 1] - mesh_.z[n] - kLeastShare * (before_[n + 1] - before_[n]);
  }

  struct Stack {
    PrismSurroundings prisms;
    std::int32_t above;  ///< The first prism above the node at hand.
  };

  ColumnMesh& mesh_;
  const std::vector<double> before_;
  const Penalty& penalty_;
  std::vector<Stack> stacks_;  ///< Around the node at hand.
};

double Improving::penalty_around(std::int64_t count, double most) const {
  double sum = 0;
  for (auto stack = stacks_.begin(); stack != stacks_.end() && sum < most; ++stack)
    for_each_penalty(stack->prisms, std::max(stack->above - 1, 0),
                     stack->above + static_cast<std::int32_t>(count), penalty_,
                     [&](std::int32_t, double own) { sum += own; });
  return sum;
}

bool Improving::move(const FreeNode& node, std::int64_t count) {
  const double most = 0.995 * penalty_around(count);
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
  };
  for (const double step : kSteps) {
    const double room = step > 0 ? up : down;
    if (!(room > 0)) continue;
    shift(step * room);
    if (penalty_around(count, most) < most) return true;
  }
  shift(0);
  return false;
}

}  // namespace

std::int64_t improve_prisms(ColumnMesh& mesh, const PrismAims& aims) {
  const Penalty penalty(aims);
  const std::vector<FreeNode> nodes = nodes_of_faults(mesh, penalty);
  Improving improving(mesh, penalty);
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
