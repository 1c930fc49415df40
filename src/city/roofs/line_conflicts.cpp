#include "city/roofs/line_conflicts.h"

#include <cmath>
#include <set>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

using NodeId = Partition::NodeId;
using EdgeId = Partition::EdgeId;

}  // namespace

bool LineConflicts::can_move(EdgeId e) const {
  const Partition::Edge& edge = lines_.edge(e);
  return !lines_.node(edge.a).corner || !lines_.node(edge.b).corner || !edge.is_outline();
}

bool LineConflicts::is_short(EdgeId e) const {
  return can_move(e) && lines_.length(e) < clearance_;
}

/// How near node n is to edge e, as far as that is a conflict; infinity otherwise.
double LineConflicts::nearness(NodeId n, EdgeId e) const {
  const Partition::Edge& edge = lines_.edge(e);
  const Partition::Node& node = lines_.node(n);
  if (edge.has(n) || (edge.is_outline() && node.corner)) return kInfinity;
  const Point2 p = node.p, a = lines_.at(edge.a), b = lines_.at(edge.b);
  const double d = distance_to_segment(p, a, b);
  if (!(d < clearance_)) return kInfinity;
  for (const NodeId end : {edge.a, edge.b}) {
    const EdgeId common = lines_.edge_between(n, end);
    if (common == Partition::kNone) continue;
    // Near for its end alone, or for an edge that is too short itself.
    if (nearest_on_segment(p, a, b) == lines_.at(end) || is_short(common)) return kInfinity;
  }
  return d;
}

double LineConflicts::angle(NodeId n, EdgeId e, EdgeId f) const {
  if (lines_.edge(e).is_outline() && lines_.edge(f).is_outline()) return kInfinity;
  return angle_between(lines_.at(n), lines_.at(lines_.edge(e).other(n)),
                       lines_.at(lines_.edge(f).other(n)));
}

template <typename Visit>
void LineConflicts::for_each_conflict_at(EdgeId e, const Visit& visit) const {
  const Partition::Edge& edge = lines_.edge(e);
  if (is_short(e)) visit(LineConflict{lines_.length(e), e});
  Bounds2 box = Bounds2::nothing();
  box.extend(lines_.at(edge.a));
  box.extend(lines_.at(edge.b));
  constexpr double kRounding = 1e-6;  // far beyond, metres
  const Bounds2 reach = box.grown(clearance_ + kRounding);
  lines_.for_each_edge_near(reach, [&](EdgeId other) {
    for (const NodeId n : {lines_.edge(other).a, lines_.edge(other).b}) {
      if (!reach.contains(lines_.at(n))) continue;
      if (const double d = nearness(n, e); d < clearance_) visit(LineConflict{d, e, n});
    }
  });
  for (const NodeId n : {edge.a, edge.b})
    for (const EdgeId f : lines_.node(n).edges)
      if (f != e)
        if (const double a = angle(n, e, f); a < min_angle_)
          // As far apart as the ends of the shorter are.
          visit(LineConflict{clearance_ * a / min_angle_, std::min(e, f), n, std::max(e, f)});
}

std::vector<LineConflict> LineConflicts::all() const {
  std::set<LineConflict> found;
  for (EdgeId e = 0; e < lines_.edges().size(); ++e)
    if (lines_.edge(e).alive)
      for_each_conflict_at(e, [&](const LineConflict& conflict) { found.insert(conflict); });
  return {found.begin(), found.end()};
}

bool LineConflicts::still_holds(const LineConflict& c) const {
  if (!lines_.edge(c.edge).alive) return false;
  if (c.node == Partition::kNone) return is_short(c.edge);
  if (c.second == Partition::kNone)
    return !lines_.node(c.node).edges.empty() && nearness(c.node, c.edge) < clearance_;
  return lines_.edge(c.second).alive && lines_.edge(c.edge).has(c.node) &&
         lines_.edge(c.second).has(c.node) && angle(c.node, c.edge, c.second) < min_angle_;
}

bool LineConflicts::is_clear(NodeId n) const {
  bool clear = true;
  const auto note = [&](const LineConflict&) { clear = false; };
  for (const EdgeId e : lines_.node(n).edges)
    if (clear) for_each_conflict_at(e, note);
  if (!clear) return false;
  // Other edges near to the node, and angles at its neighbours.
  const Point2 p = lines_.at(n);
  lines_.for_each_edge_near(Bounds2{p.x, p.y, p.x, p.y}.grown(clearance_), [&](EdgeId e) {
    if (clear && nearness(n, e) < clearance_) clear = false;
  });
  return clear;
}

}  // namespace tetropolis
