#include "city/roofs/clear_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "city/roofs/line_conflicts.h"
#include "core/infinity.h"
#include "geometry/predicates.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

using NodeId = Partition::NodeId;
using EdgeId = Partition::EdgeId;
using Region = Partition::Region;
constexpr std::size_t kNone = Partition::kNone;

Point2 between(Point2 a, Point2 b, double t) {
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t};
}
/// Up to three.
struct Nodes {
  NodeId a = kNone, b = kNone, c = kNone;
};

/// Something that may be done to lines around nodes, and its cost.
struct Way {
  double cost;
  Nodes nodes;
  std::function<bool()> go;  ///< False: it cannot be done.
};

class Clearing {
 public:
  Clearing(Partition& lines, RegionPoints& points, const ClearLinesOptions& options)
      : lines_(lines),
        points_(points),
        options_(options),
        min_angle_(options.min_angle * std::numbers::pi / 180),
        conflicts_(lines, options.clearance, min_angle_) {}

  std::vector<Point2> run() {
    split();
    bool polished = false;
    for (int round = 0;; ++round) {
      constexpr int kFreeRounds = 24, kCalmRounds = 4;
      only_removals_ = round >= kFreeRounds;
      is_restless_ = round >= kCalmRounds && !only_removals_;
      drop_small_regions();
      const std::vector<LineConflict> found = conflicts_.all();
      if (found.empty() && !part_pinched()) {
        if (polished || !options_.polish) break;
        polished = true;
        is_restless_ = false;
        polish();
      }
      bool any = false;
      too_costly_.clear();
      for (const LineConflict& conflict : found)
        if (conflicts_.still_holds(conflict)) any = resolve(conflict) || any;
      if (!any && !found.empty() && only_removals_) break;  // the outline's own
      split();
      points_.fit();
    }
    return std::move(too_costly_);
  }

 private:
  // ---------------------------------------------------------------- what things cost

  Region left_of(EdgeId e, NodeId from) const {
    return lines_.edge(e).a == from ? lines_.edge(e).left : lines_.edge(e).right;
  }
  Region right_of(EdgeId e, NodeId from) const {
    return lines_.edge(e).a == from ? lines_.edge(e).right : lines_.edge(e).left;
  }

  /// Of leading edge e, seen from its end `from`, through x instead of straight.
  double cost_of_bend(EdgeId e, NodeId from, Point2 x) const {
    const Point2 a = lines_.at(from), b = lines_.at(lines_.edge(e).other(from));
    const Region l = left_of(e, from), r = right_of(e, from);
    return orient2d(a, b, x) > 0 ? points_.cost_of_triangle(a, b, x, l, r)
                                 : points_.cost_of_triangle(a, b, x, r, l);
  }

  /// Of moving a node, but for an edge that vanishes.
  double cost_of_move(NodeId n, Point2 to, EdgeId gone = kNone) const {
    if (lines_.at(n) == to) return 0;
    double sum = 0;
    for (const EdgeId e : lines_.node(n).edges) {
      if (e == gone || lines_.edge(e).is_outline()) continue;
      sum += cost_of_bend(e, n, to);
    }
    return sum;
  }

  double cost_of_straightening(NodeId n) const {
    const EdgeId e = lines_.node(n).edges[0], f = lines_.node(n).edges[1];
    return cost_of_bend(e, lines_.edge(e).other(n), lines_.at(lines_.edge(f).other(n)));
  }

  // ---------------------------------------------------------------- what can be done

  /// Does it, and lets the points know.
  bool go(const Way& way) {
    Bounds2 box = Bounds2::nothing();
    const auto extend = [&] {
      for (const NodeId n : {way.nodes.a, way.nodes.b, way.nodes.c}) {
        if (n == kNone) break;
        box.extend(lines_.at(n));
        for (const EdgeId e : lines_.node(n).edges) box.extend(lines_.at(lines_.edge(e).other(n)));
      }
    };
    extend();
    if (!way.go()) return false;
    if (is_restless_)
      for (const NodeId n : {way.nodes.a, way.nodes.b, way.nodes.c})
        if (n != kNone) ++visits_[n];
    if (way.nodes.a == kNone) return true;
    extend();
    lines_.tidy();
    points_.update(box, lines_);
    return true;
  }

  template <typename Go>
  void add(double cost, const Nodes& nodes, Go go) {
    // Ways may undo each other for ever: what is done again and again at a node costs more.
    constexpr double kAgain = 1;  // m^4
    if (is_restless_)
      for (const NodeId n : {nodes.a, nodes.b, nodes.c})
        if (n != kNone) cost += kAgain * visits_[n] * (1 + visits_[n] / 8.0);
    ways_.push_back({cost, nodes, std::move(go)});
  }

  void offer_collapse(EdgeId e) {
    const NodeId a = lines_.edge(e).a, b = lines_.edge(e).b;
    const auto rank = [&](NodeId n) {
      return lines_.node(n).corner ? 2 : lines_.node(n).on_outline ? 1 : 0;
    };
    const auto offer = [&](NodeId kept, Point2 to) {
      const NodeId gone = lines_.edge(e).other(kept);
      add(cost_of_move(a, to, e) + cost_of_move(b, to, e), {a, b},
          [this, e, kept, gone, to] { return gone != kNone && lines_.collapse(e, kept, to); });
    };
    if (rank(a) >= rank(b)) offer(a, lines_.at(a));
    if (rank(b) >= rank(a)) offer(b, lines_.at(b));
    if (rank(a) == 0 && rank(b) == 0) offer(a, between(lines_.at(a), lines_.at(b), 0.5));
  }

  void offer_straightening(NodeId n) {
    const Partition::Node& node = lines_.node(n);
    if (node.corner || node.on_outline || node.edges.size() != 2) return;
    add(cost_of_straightening(n), {n}, [this, n] { return lines_.straighten(n); });
  }

  /// Places near to a node where it may go.
  std::vector<Point2> places_near(NodeId n) const {
    const Partition::Node& node = lines_.node(n);
    std::vector<Point2> result;
    if (node.corner) return result;
    if (node.on_outline) {
      for (const EdgeId e : node.edges) {
        if (!lines_.edge(e).is_outline()) continue;
        const Point2 o = lines_.at(lines_.edge(e).other(n));
        const double length = distance(node.p, o);
        for (const double step : {0.1, 0.25, 0.5, 0.75, 1.0})
          if (step * options_.clearance < length)
            result.push_back(between(node.p, o, step * options_.clearance / length));
      }
      return result;
    }
    constexpr int kDirections = 12;
    for (int k = 0; k < kDirections; ++k) {
      const double t = 2 * std::numbers::pi * k / kDirections;
      for (const double step : {0.1, 0.25, 0.5, 0.8}) {
        const double far = step * options_.clearance;
        result.push_back({node.p.x + far * std::cos(t), node.p.y + far * std::sin(t)});
      }
    }
    return result;
  }

  bool move_if_clear(NodeId n, Point2 to) {
    const Point2 from = lines_.at(n);
    if (!lines_.move(n, to)) return false;
    if (conflicts_.is_clear(n)) return true;
    lines_.put_back(n, from);
    return false;
  }

  void offer_moves(NodeId n) {
    const std::vector<Point2> places = places_near(n);
    std::vector<double> costs(places.size(), 0);
    for (const EdgeId e : lines_.node(n).edges)
      points_.add_costs_of_moves(lines_.at(n), lines_.at(lines_.edge(e).other(n)), places,
                                 left_of(e, n), right_of(e, n), costs);
    for (std::size_t k = 0; k < places.size(); ++k)
      add(costs[k], {n}, [this, n, to = places[k]] { return move_if_clear(n, to); });
  }

  void offer_merges(const std::vector<NodeId>& nodes, EdgeId e) {
    std::set<std::pair<Region, Region>> pairs;
    const auto note = [&](EdgeId f) {
      const Region l = lines_.edge(f).left, r = lines_.edge(f).right;
      if (l != Partition::kOutside && r != Partition::kOutside && l != r)
        pairs.insert({std::min(l, r), std::max(l, r)});
    };
    note(e);
    for (const NodeId n : nodes)
      for (const EdgeId f : lines_.node(n).edges) note(f);
    merges_.insert(merges_.end(), pairs.begin(), pairs.end());
  }

  void offer_merge(Region a, Region b) {
    add(points_.cost_of_merging(a, b), {}, [this, a, b] {
      merge(a, b);
      return true;
    });
  }

  void merge(Region a, Region b) {
    lines_.merge(a, b);
    points_.merge(a, b);
  }

  // ---------------------------------------------------------------- lines from corner to corner

  /// The place `far` or, to keep the clearance from corners, a little further along the outline
  /// from its corner n, with region `in` beside; nullopt where another line ends before.
  std::optional<Partition::OutlinePlace> along_outline(NodeId n, Region in, double far) const {
    Partition::OutlinePlace place;
    EdgeId last = kNone;
    for (std::size_t k = 0; k < lines_.nodes().size(); ++k) {
      const auto& edges = lines_.node(n).edges;
      if (last != kNone && edges.size() != 2) return std::nullopt;
      const auto next = std::find_if(edges.begin(), edges.end(), [&](EdgeId f) {
        const Partition::Edge& edge = lines_.edge(f);
        return f != last && edge.is_outline() && (edge.left == in || edge.right == in);
      });
      if (next == edges.end()) return std::nullopt;
      const double length = lines_.length(*next);
      far = std::max(far, options_.clearance);
      if (far <= length - options_.clearance) {
        place.on = *next;
        place.p = between(lines_.at(n), lines_.at(lines_.edge(*next).other(n)), far / length);
        return place;
      }
      far -= length;
      place.passed.push_back(last = *next);
      n = lines_.edge(*next).other(n);
    }
    return std::nullopt;
  }

  /// The corners from an end of edge e to a place on the outline, and the place.
  std::vector<Point2> way_to(const Partition::OutlinePlace& place, NodeId n) const {
    std::vector<Point2> way{lines_.at(n)};
    for (const EdgeId side : place.passed) way.push_back(lines_.at(n = lines_.edge(side).other(n)));
    way.push_back(place.p);
    return way;
  }

  /// Whether a line between two places on the outline keeps the clearance and its angles.
  bool may_cut(EdgeId e, const Partition::OutlinePlace& from,
               const Partition::OutlinePlace& to) const {
    const Point2 x = from.p, y = to.p;
    if (distance(x, y) < options_.clearance) return false;
    for (const auto& [place, other] : {std::pair(&from, y), std::pair(&to, x)})
      for (const NodeId n : {lines_.edge(place->on).a, lines_.edge(place->on).b})
        if (angle_between(place->p, lines_.at(n), other) < min_angle_) return false;
    Bounds2 box = Bounds2::nothing();
    box.extend(x);
    box.extend(y);
    bool clear = true;
    lines_.for_each_edge_near(box.grown(options_.clearance), [&](EdgeId f) {
      const Partition::Edge& edge = lines_.edge(f);
      const Point2 a = lines_.at(edge.a), b = lines_.at(edge.b);
      if (f == e) return;
      for (const NodeId n : {edge.a, edge.b})
        clear = clear && distance_to_segment(lines_.at(n), x, y) >= options_.clearance;
      clear = clear && (f == from.on || distance_to_segment(x, a, b) >= options_.clearance) &&
              (f == to.on || distance_to_segment(y, a, b) >= options_.clearance);
    });
    return clear;
  }

  /// Edge e is between two corners with no room for it, as where houses touch at theirs: it goes
  /// into the region on one of its sides, to where there is.
  void offer_pushes(EdgeId e) {
    const Partition::Edge edge = lines_.edge(e);
    if (only_removals_ || edge.is_outline() || !lines_.node(edge.a).corner ||
        !lines_.node(edge.b).corner)
      return;
    constexpr std::array kSteps{1.0, 1.5, 2.0, 3.0, 4.0, 6.0};
    const auto places = [&](NodeId n, Region in) {
      std::array<std::optional<Partition::OutlinePlace>, kSteps.size()> found;
      for (std::size_t k = 0; k < kSteps.size(); ++k)
        found[k] = along_outline(n, in, kSteps[k] * options_.clearance);
      return found;
    };
    for (const Region in : {edge.left, edge.right}) {
      const auto beside_a = places(edge.a, in), beside_b = places(edge.b, in);
      for (const auto& from_a : beside_a)
        for (const auto& from_b : beside_b) {
          if (!from_a || !from_b || !may_cut(e, *from_a, *from_b)) continue;
          std::vector<Point2> ring = way_to(*from_a, edge.a);
          const std::vector<Point2> back = way_to(*from_b, edge.b);
          ring.insert(ring.end(), back.rbegin(), back.rend());
          add(cost_of_ring(ring, in, in == edge.left ? edge.right : edge.left), {},
              [this, e, in, a = *from_a, b = *from_b, ring] {
                if (holds_node(ring) || !lines_.push(e, in, a, b)) return false;
                Bounds2 box = Bounds2::nothing();
                for (const Point2 p : ring) box.extend(p);
                lines_.tidy();
                points_.update(box, lines_);
                return true;
              });
        }
    }
  }

  /// Of what is in a ring, from one region to another.
  double cost_of_ring(const std::vector<Point2>& ring, Region from, Region to) const {
    double sum = 0, area = 0;
    for (std::size_t k = 2; k < ring.size(); ++k) {
      const double turn = orient2d(ring[0], ring[k - 1], ring[k]);
      area += turn;
      if (turn > 0) sum += points_.cost_of_triangle(ring[0], ring[k - 1], ring[k], from, to);
      if (turn < 0) sum -= points_.cost_of_triangle(ring[0], ring[k], ring[k - 1], from, to);
    }
    return area < 0 ? -sum : sum;
  }

  bool holds_node(const std::vector<Point2>& ring) const {
    return std::any_of(lines_.nodes().begin(), lines_.nodes().end(), [&](const auto& node) {
      return !node.edges.empty() && std::find(ring.begin(), ring.end(), node.p) == ring.end() &&
             contains({ring, {}}, node.p);
    });
  }

  void offer_separation(NodeId n, EdgeId e) {
    const Partition::Edge edge = lines_.edge(e);
    const Partition::Node& node = lines_.node(n);
    const Point2 p = node.p, a = lines_.at(edge.a), b = lines_.at(edge.b);
    offer_straightening(n);
    offer_straightening(edge.a);
    offer_straightening(edge.b);
    for (const NodeId end : {edge.a, edge.b})
      if (distance(lines_.at(end), p) < options_.clearance)
        if (const EdgeId common = lines_.edge_between(n, end); common != kNone)
          offer_collapse(common);
    if (only_removals_) return;
    offer_moves(n);
    offer_moves(edge.a);
    offer_moves(edge.b);
    offer_bends(n, e);
    offer_pushes(e);
    for (const NodeId end : {edge.a, edge.b})
      if (lines_.node(end).corner && !edge.is_outline())
        for (const EdgeId side : lines_.node(end).edges)
          if (side != e) offer_branches(e, end, side, true);
    if (!edge.is_outline()) {
      add(cost_of_bend(e, edge.a, p), {n, edge.a, edge.b},
          [this, e, n] { return lines_.lead_through(e, n) || lines_.fold(e, n); });
    }
    if (!node.on_outline) {
      const Point2 foot = nearest_on_segment(p, a, b);
      add(cost_of_move(n, foot), {n, edge.a, edge.b},
          [this, n, e, foot] { return lines_.move_onto(n, e, foot); });
    } else if (!node.corner && edge.is_outline()) {
      // A line that leaves the outline near a sharp corner leaves at the corner.
      for (const EdgeId side : node.edges)
        if (lines_.edge(side).is_outline() && edge.has(lines_.edge(side).other(n)))
          offer_collapse(side);
    }
  }

  /// Edge `moved` leaves edge `kept` further along it than at node n.
  void offer_branches(EdgeId moved, NodeId n, EdgeId kept, bool only_clear = false) {
    if (lines_.edge(moved).is_outline()) return;
    const NodeId end = lines_.edge(moved).other(n), other = lines_.edge(kept).other(n);
    const double length = lines_.length(kept);
    const Point2 c = lines_.at(end);
    const Region inside =
        orient2d(lines_.at(n), lines_.at(other), c) > 0 ? left_of(kept, n) : right_of(kept, n);
    if (inside != left_of(moved, n) && inside != right_of(moved, n)) return;
    const Region beyond = left_of(moved, n) == inside ? right_of(moved, n) : left_of(moved, n);
    const auto cost = [&](Point2 x) {
      return points_.cost_of_triangle(lines_.at(n), x, c, inside, beyond);
    };
    for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 8.0}) {
      const double along = step * options_.clearance;
      if (along > length - options_.clearance) break;
      const Point2 x = between(lines_.at(n), lines_.at(other), along / length);
      if (angle_between(x, c, lines_.at(other)) < min_angle_) break;
      if (angle_between(x, c, lines_.at(n)) < min_angle_) continue;
      if (only_clear && !would_be_clear(x, kept, end, moved)) continue;
      add(cost(x), {n, end, other},
          [this, moved, n, kept, x] { return lines_.branch_at(moved, n, kept, x); });
    }
    if (only_clear) return;
    add(cost(lines_.at(other)), {n, end, other},
        [this, moved, n, kept] { return lines_.branch_at_end(moved, n, kept); });
  }

  /// Edge e is too near to node n, which has an edge to an end of it, as at a jog of the outline:
  /// it leaves that end square to that edge, or away from it, and bends.
  void offer_bends(NodeId n, EdgeId e) {
    if (lines_.edge(e).is_outline()) return;
    for (const NodeId end : {lines_.edge(e).a, lines_.edge(e).b}) {
      if (lines_.edge_between(n, end) == kNone) continue;
      const Point2 a = lines_.at(end), b = lines_.at(lines_.edge(e).other(end)), p = lines_.at(n);
      const double toward = std::atan2(p.y - a.y, p.x - a.x);
      const double side = orient2d(a, p, b) > 0 ? 1 : -1;
      for (const double degrees : {91.0, 97.0, 105.0, 115.0, 130.0})
        for (const double step : {1.05, 1.5, 2.5, 4.0}) {
          const double direction = toward + side * degrees * std::numbers::pi / 180;
          const double far = step * options_.clearance;
          const Point2 x{a.x + far * std::cos(direction), a.y + far * std::sin(direction)};
          if (distance(x, b) > options_.clearance && may_bend(e, end, x))
            add(cost_of_bend(e, end, x), {end, lines_.edge(e).other(end)},
                [this, e, x] { return lines_.bend(e, x); });
        }
    }
  }

  /// Whether edge e may run through x without anything being too close.
  bool may_bend(EdgeId e, NodeId from, Point2 x) const {
    const NodeId to = lines_.edge(e).other(from);
    const Point2 a = lines_.at(from), b = lines_.at(to);
    if (angle_between(x, a, b) < std::numbers::pi / 2) return false;
    for (const NodeId end : {from, to})
      for (const EdgeId f : lines_.node(end).edges)
        if (f != e &&
            angle_between(lines_.at(end), x, lines_.at(lines_.edge(f).other(end))) < min_angle_)
          return false;
    Bounds2 box = Bounds2::nothing();
    for (const Point2 p : {a, b, x}) box.extend(p);
    bool clear = true;
    const auto is_near = [&](NodeId n, NodeId end) {
      const Point2 p = lines_.at(n), q = lines_.at(end);
      if (distance_to_segment(p, q, x) >= options_.clearance) return false;
      return !(nearest_on_segment(p, q, x) == q && lines_.edge_between(n, end) != kNone);
    };
    lines_.for_each_edge_near(box.grown(options_.clearance), [&](EdgeId f) {
      if (f == e || !clear) return;
      const Partition::Edge& edge = lines_.edge(f);
      clear = distance_to_segment(x, lines_.at(edge.a), lines_.at(edge.b)) >= options_.clearance;
      for (const NodeId n : {edge.a, edge.b})
        if (n != from && n != to) clear = clear && !is_near(n, from) && !is_near(n, to);
    });
    return clear;
  }

  /// Whether nothing is near to a new node at x on edge `kept`, and to an edge from it to `end`,
  /// which stands for `moved`.
  bool would_be_clear(Point2 x, EdgeId kept, NodeId end, EdgeId moved) const {
    const Point2 c = lines_.at(end);
    Bounds2 box = Bounds2::nothing();
    box.extend(x);
    box.extend(c);
    bool clear = true;
    lines_.for_each_edge_near(box.grown(options_.clearance), [&](EdgeId e) {
      const Partition::Edge& edge = lines_.edge(e);
      const Point2 a = lines_.at(edge.a), b = lines_.at(edge.b);
      if (e != kept && e != moved && distance_to_segment(x, a, b) < options_.clearance)
        clear = false;
      for (const NodeId n : {edge.a, edge.b})
        if (n != end && distance_to_segment(lines_.at(n), x, c) < options_.clearance) clear = false;
    });
    return clear;
  }

  /// Edges e and f meet at node n at too small an angle.
  void offer_opening(NodeId n, EdgeId e, EdgeId f) {
    if (lines_.length(e) < lines_.length(f)) std::swap(e, f);
    const NodeId far = lines_.edge(e).other(n), near = lines_.edge(f).other(n);
    offer_straightening(n);
    offer_straightening(far);
    offer_straightening(near);
    offer_collapse(f);
    offer_collapse(e);
    if (only_removals_) return;
    for (const NodeId k : {n, far, near}) offer_moves(k);
    if (!lines_.edge(e).is_outline())
      add(cost_of_bend(e, n, lines_.at(near)), {n, far, near},
          [this, e, near] { return lines_.fold(e, near); });
    if (!lines_.node(near).on_outline) {
      const Point2 foot = nearest_on_segment(lines_.at(near), lines_.at(n), lines_.at(far));
      add(cost_of_move(near, foot, f), {n, far, near},
          [this, near, e, foot] { return lines_.move_onto(near, e, foot); });
    }
    offer_branches(f, n, e);
    offer_branches(e, n, f);
  }

  bool go_cheapest() {
    const auto by_cost = [](const Way& a, const Way& b) { return a.cost < b.cost; };
    std::stable_sort(ways_.begin(), ways_.end(), by_cost);
    // One roof for two regions fits no better than two: that takes long to find out.
    std::size_t tried = 0;
    for (; tried < ways_.size() && ways_[tried].cost <= 0; ++tried)
      if (go(ways_[tried])) return true;
    ways_.erase(ways_.begin(), ways_.begin() + static_cast<std::ptrdiff_t>(tried));
    for (const auto& [a, b] : merges_) offer_merge(a, b);
    std::stable_sort(ways_.begin(), ways_.end(), by_cost);
    for (const Way& way : ways_) {
      is_too_costly_ = way.cost > options_.most_cost;
      if (is_too_costly_) return false;
      if (go(way)) return true;
    }
    return false;
  }

  /// A region that meets itself at a node gives way there. Whether there was one.
  bool part_pinched() {
    for (const Partition::Face& face : lines_.faces()) {
      std::set<NodeId> seen;
      for (const std::vector<NodeId>& ring : face.rings)
        for (const NodeId n : ring) {
          if (seen.insert(n).second) continue;
          ways_.clear();
          merges_.clear();
          offer_merges({n}, lines_.node(n).edges.front());
          if (go_cheapest()) return true;
        }
    }
    return false;
  }

  bool resolve(const LineConflict& conflict) {
    ways_.clear();
    merges_.clear();
    const Partition::Edge edge = lines_.edge(conflict.edge);
    std::vector<NodeId> nodes{conflict.node};
    if (conflict.node == kNone) {
      nodes = {edge.a, edge.b};
      offer_collapse(conflict.edge);
      offer_pushes(conflict.edge);
      for (const NodeId n : nodes) {
        offer_straightening(n);
        if (!only_removals_) offer_moves(n);
      }
    } else if (conflict.second == kNone) {
      offer_separation(conflict.node, conflict.edge);
    } else {
      offer_opening(conflict.node, conflict.edge, conflict.second);
    }
    // Two places on the outline are too close for a line that ends at one of them.
    for (const NodeId n : {edge.a, edge.b})
      if (edge.is_outline() && !lines_.node(n).corner) nodes.push_back(n);
    offer_merges(nodes, conflict.edge);
    is_too_costly_ = false;
    const Point2 at = lines_.at(conflict.node == kNone ? edge.a : conflict.node);
    const bool went = go_cheapest();
    if (!went && is_too_costly_) too_costly_.push_back(at);
    return went;
  }

  /// Moves single nodes to where their lines fit better.
  void polish() {
    constexpr int kPasses = 3;
    for (int pass = 0; pass < kPasses; ++pass) {
      bool any = false;
      for (NodeId n = 0; n < lines_.nodes().size(); ++n) {
        if (lines_.node(n).edges.empty()) continue;
        ways_.clear();
        merges_.clear();
        offer_moves(n);
        constexpr double kGain = 1e-2;  // m^4
        std::erase_if(ways_, [](const Way& way) { return way.cost > -kGain; });
        any = go_cheapest() || any;
      }
      points_.fit();
      if (!any) return;
    }
  }

  // ---------------------------------------------------------------- regions

  void split() {
    const std::vector<Region> origins =
        lines_.split_regions(static_cast<Region>(points_.roofs().size()));
    if (origins.empty()) return;
    for (const Region origin : origins) points_.add_region(origin);
    Bounds2 all = Bounds2::nothing();
    for (const Partition::Node& node : lines_.nodes())
      if (!node.edges.empty()) all.extend(node.p);
    points_.update(all, lines_);
  }

  void drop_small_regions() {
    std::map<Region, double> areas = lines_.areas();
    while (areas.size() > 1) {
      const auto least =
          std::min_element(areas.begin(), areas.end(),
                           [](const auto& a, const auto& b) { return a.second < b.second; });
      if (least->second >= options_.min_area) return;
      const Region gone = least->first;
      double best_cost = kInfinity;
      Region best = Partition::kOutside;
      for (const auto& [other, border] : lines_.neighbours(gone)) {
        const double cost = points_.cost_of_merging(other, gone) - 1e-3 * border;
        if (cost < best_cost) best_cost = cost, best = other;
      }
      if (best == Partition::kOutside) {  // in a courtyard of its own
        areas.erase(least);
        continue;
      }
      merge(best, gone);
      areas = lines_.areas();
    }
  }

  Partition& lines_;
  RegionPoints& points_;
  const ClearLinesOptions& options_;
  double min_angle_;
  LineConflicts conflicts_;
  bool only_removals_ = false;
  bool is_restless_ = false;
  std::map<NodeId, int> visits_;  ///< How often ways have changed a node in restless rounds.
  bool is_too_costly_ = false;
  std::vector<Point2> too_costly_;
  std::vector<Way> ways_;
  std::vector<std::pair<Region, Region>> merges_;
};

}  // namespace

std::vector<Point2> clear_lines(Partition& lines, RegionPoints& points,
                                const ClearLinesOptions& options) {
  return Clearing(lines, points, options).run();
}

}  // namespace tetropolis
