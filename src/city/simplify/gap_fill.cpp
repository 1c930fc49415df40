#include "gap_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "city/edge_grid.h"
#include "city/grid_geometry.h"
#include "core/infinity.h"
#include "core/sort_once.h"
#include "geometry/convex_hull.h"
#include "merge_polygons.h"

namespace tetropolis {

namespace {

constexpr std::ptrdiff_t kMostPairs = 12;  // of one vertex
/// Pairs of one polygon from which on it gets no more gap fills than it needs.
constexpr std::int32_t kCrowdOfPairs = 50'000;

/// Whether leaving vertex v towards q one is inside the polygon.
bool leads_inside(const Outline& o, OutlineVertex v, Point2 q) {
  const Point2 p = o.at(v), u = o.at(o.before(v)), w = o.at(o.after(v));
  const auto side = [](Point2 a, Point2 b, Point2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const bool left_of_in = side(u, p, q) > 0, left_of_out = side(p, w, q) > 0;
  return grid::orientation(u, p, w) > 0 ? left_of_in && left_of_out : left_of_in || left_of_out;
}

/// Area of the smaller of the two parts into which the segment from v to a point of edge e would
/// cut a ring; infinity if the ring is long (it is then not worth the walk), 0 if v and e belong to
/// different rings.
double smaller_part(const Outline& o, OutlineVertex v, OutlineVertex e) {
  if (o.ring_of(v) != o.ring_of(e)) return 0;
  const auto walk = [&](OutlineVertex from, OutlineVertex to) {
    const Point2 origin = o.at(v);
    double twice = 0;
    int steps = 0;
    for (OutlineVertex i = from; i != to; i = o.after(i)) {
      const Point2 a = o.at(i), b = o.at(o.after(i));
      twice += (a.x - origin.x) * (b.y - origin.y) - (b.x - origin.x) * (a.y - origin.y);
      if (++steps > 2000) return kInfinity;
    }
    return std::abs(twice) / 2;
  };
  return std::min(walk(v, e), walk(o.after(e), v));
}

/// The smallest box around the thin place between walls e and f that is a little wider than
/// epsilon: along either wall, or across the shortest way p-q between them.
Polygon widening(const Outline& o, const Ring& thin, OutlineVertex e, OutlineVertex f, Point2 p,
                 Point2 q, double epsilon) {
  Polygon best;
  const std::array<std::pair<Point2, Point2>, 3> directions{
      {{o.at(e), o.at(o.after(e))}, {o.at(f), o.at(o.after(f))}, {p, q}}};
  for (const auto& [from, to] : directions) {
    Polygon box = box_along(thin, from, to, epsilon);
    if (box.outer.empty()) continue;
    if (best.outer.empty() || signed_area(box.outer) < signed_area(best.outer))
      best = std::move(box);
  }
  return best;
}

bool face(const Outline& o, OutlineVertex e, OutlineVertex f, double epsilon) {
  return edges_face(o.at(e), o.at(o.after(e)), o.at(f), o.at(o.after(f)), epsilon);
}

void add_fill_or_cut(const Outline& o, const NearPair& pair, OutlineVertex f, double epsilon,
                     double reach, FillsAndCuts& repairs) {
  const OutlineVertex e = pair.edge;
  if (f == e) return;
  const Point2 a = o.at(e), b = o.at(o.after(e));
  Ring hull = gap_fill(o.at(f), o.at(o.after(f)), a, b, reach);
  if (hull.empty()) return;
  const Point2 p = o.at(pair.vertex), q = grid::nearest_on_segment(p, a, b);
  if (p == q || !leads_inside(o, pair.vertex, q)) {
    repairs.fill.push_back({std::move(hull), {}});
    return;
  }
  Polygon wider = widening(o, hull, e, f, p, q, epsilon);
  const double thin = signed_area(hull);
  const double cost_of_cutting = std::max(thin, smaller_part(o, pair.vertex, e));
  const double cost_of_widening = signed_area(wider.outer) - thin;
  if (wider.outer.empty() || cost_of_cutting <= cost_of_widening) {
    repairs.widen.push_back(wider.outer.empty() ? Polygon{hull, {}} : std::move(wider));
    repairs.cut.push_back({std::move(hull), {}});
  } else {
    repairs.fill.push_back(std::move(wider));
    ++repairs.widened;
  }
}

/// The edges of fillings, to be asked what meets them.
class Fillings {
 public:
  Fillings(const std::vector<Polygon>& fill, double epsilon) {
    Bounds2 box = Bounds2::nothing();
    for (std::size_t k = 0; k < fill.size(); ++k) {
      widest_ = std::max(widest_, bounds(fill[k]).width());
      for_each_edge(fill[k], [&](Point2 a, Point2 b) {
        edges_.push_back({a, b, k});
        box.extend(a);
      });
    }
    index_ = EdgeGrid(box, 4 * epsilon, edges_.size());
    for (const LineIndex e : indices<LineIndex>(edges_.size()))
      index_.insert(e, edges_[e].a, edges_[e].b);
  }

  /// Whether one of them has a point in common with the polygon, unless it lies inside that.
  bool meet(const Polygon& polygon) {
    bool touches = false;
    for_each_edge(polygon, [&](Point2 a, Point2 b) {
      touches = touches || index_.any(grid::box_of(a, b), [&](LineIndex e) {
        const Edge& edge = edges_[e];
        return grid::segments_touch(a, b, edge.a, edge.b);
      });
    });
    return touches || contain(polygon.outer[0]);
  }

 private:
  struct Edge {
    Point2 a;
    Point2 b;
    std::size_t filling;
  };

  /// Whether one of them contains the point: the edges left of it, by the even-odd rule.
  bool contain(Point2 p) {
    crossed_.clear();
    index_.visit({p.x - widest_, p.y, p.x, p.y}, [&](LineIndex e) {
      const Edge& edge = edges_[e];
      if (grid::crossing_side(edge.a, edge.b, p) < 0) crossed_.push_back(e);
    });
    sort_once(crossed_);
    // The edges of one filling follow each other.
    std::size_t count = 0;
    for (std::size_t i = 0; i < crossed_.size(); ++i) {
      ++count;
      if (i + 1 < crossed_.size() && filling(i) == filling(i + 1)) continue;
      if (count % 2 == 1) return true;
      count = 0;
    }
    return false;
  }
  std::size_t filling(std::size_t i) const { return edges_[crossed_[i]].filling; }

  std::vector<Edge> edges_;
  double widest_ = 0;
  EdgeGrid index_;
  std::vector<LineIndex> crossed_;
};

/// Puts off cuts that meet a filling: what is thin may be so no longer then, and where teeth and
/// gaps alternate they would only change places.
void put_off_cuts(FillsAndCuts& repairs, double epsilon) {
  if (repairs.fill.empty() || repairs.cut.empty()) return;
  Fillings fillings(repairs.fill, epsilon);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < repairs.cut.size(); ++i) {
    if (fillings.meet(repairs.cut[i])) continue;
    if (kept != i) {
      repairs.cut[kept] = std::move(repairs.cut[i]);
      repairs.widen[kept] = std::move(repairs.widen[i]);
    }
    ++kept;
  }
  repairs.cut.resize(kept);
  repairs.widen.resize(kept);
}

/// The pairs of which no more than kMostPairs of the same vertex are nearer: where walls crowd, the
/// others lie behind these, and have their turn in the next round if they are still there.
std::vector<NearPair> nearest_pairs(const std::vector<NearPair>& pairs) {
  std::vector<NearPair> nearest;
  nearest.reserve(pairs.size());
  std::vector<double> distances;
  for (auto begin = pairs.begin(); begin != pairs.end();) {
    const auto end = std::find_if(
        begin, pairs.end(), [&](const NearPair& pair) { return pair.vertex != begin->vertex; });
    double most = kInfinity;
    if (end - begin > kMostPairs) {
      distances.clear();
      for (auto pair = begin; pair != end; ++pair) distances.push_back(pair->distance);
      std::nth_element(distances.begin(), distances.begin() + kMostPairs, distances.end());
      most = distances[kMostPairs];
    }
    std::copy_if(begin, end, std::back_inserter(nearest),
                 [&](const NearPair& pair) { return pair.distance <= most; });
    begin = end;
  }
  return nearest;
}

/// Polygons with very many pairs, and which walls of them have a gap fill already: every gap fill
/// would come from both ends of both walls.
class Crowds {
 public:
  Crowds(const Outline& o, const std::vector<NearPair>& pairs) : o_(o), pairs_(o.changed.size()) {
    for (const NearPair& pair : pairs) ++pairs_[o.polygon_of(pair.vertex)];
  }
  bool has(OutlineVertex v) const { return pairs_[o_.polygon_of(v)] >= kCrowdOfPairs; }
  /// Whether it is asked about these two walls for the first time.
  bool is_new(OutlineVertex e, OutlineVertex f) { return seen_.insert(std::minmax(e, f)).second; }

 private:
  const Outline& o_;
  std::vector<std::int32_t> pairs_;
  std::set<std::pair<OutlineVertex, OutlineVertex>> seen_;
};

/// Whether q, the point of wall e nearest to vertex v, is an end of e from which another wall goes
/// that faces one of v's: that one's gap fill closes the gap, and e's would round off a corner
/// only.
bool is_next_to_facing(const Outline& o, OutlineVertex v, OutlineVertex e, Point2 q,
                       double epsilon) {
  const bool at_start = q == o.at(e);
  if (!at_start && q != o.at(o.after(e))) return false;
  const OutlineVertex other = at_start ? o.before(e) : o.after(e);
  return face(o, o.before(v), other, epsilon) || face(o, v, other, epsilon);
}

}  // namespace

std::vector<FillsAndCuts> fills_and_cuts(const Outline& o, const std::vector<NearPair>& pairs,
                                         double epsilon, double reach) {
  std::vector<FillsAndCuts> result(o.changed.size());
  const std::vector<NearPair> nearest = nearest_pairs(pairs);
  Crowds crowds(o, nearest);
  for (const NearPair& pair : nearest) {
    const OutlineVertex v = pair.vertex, e = pair.edge;
    if (o.polygon_of(v) != o.polygon_of(e)) continue;
    const Point2 q = grid::nearest_on_segment(o.at(v), o.at(e), o.at(o.after(e)));
    if (q != o.at(v) && (q == o.at(o.before(v)) || q == o.at(o.after(v)))) continue;
    if (crowds.has(v) && is_next_to_facing(o, v, e, q, epsilon)) continue;
    FillsAndCuts& repairs = result[o.polygon_of(v)];
    const auto add = [&](OutlineVertex f) {
      if (!crowds.has(v) || crowds.is_new(e, f))
        add_fill_or_cut(o, pair, f, epsilon, reach, repairs);
    };
    // Where one of the two walls at the vertex faces the edge, the other's gap fill would round off
    // its corner only.
    const bool before = face(o, o.before(v), e, epsilon), after = face(o, v, e, epsilon);
    if (before || !after) add(o.before(v));
    if (after || !before) add(v);
  }
  for (FillsAndCuts& repairs : result) put_off_cuts(repairs, epsilon);
  return result;
}

std::vector<FillsAndCuts> hulls_around(const Outline& o, const std::vector<NearPair>& pairs,
                                       double radius) {
  std::vector<FillsAndCuts> result(o.changed.size());
  for (const NearPair& pair : pairs) {
    const Point2 p = o.at(pair.vertex);
    Ring points{p, o.at(o.before(pair.vertex)), o.at(o.after(pair.vertex))};
    // Long walls are covered as far as the radius only.
    for (std::size_t i = 1; i < 3; ++i) {
      const double d = grid::distance(points[i], p);
      if (d > radius)
        points[i] = grid::rounded(
            {p.x + (points[i].x - p.x) * radius / d, p.y + (points[i].y - p.y) * radius / d});
    }
    o.grid.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(radius), [&](OutlineVertex w) {
      if (o.polygon_of(w) == o.polygon_of(pair.vertex) && grid::distance(o.at(w), p) <= radius)
        points.push_back(o.at(w));
    });
    Ring hull = convex_hull(std::move(points));
    if (hull.size() < 3) continue;
    FillsAndCuts& repairs = result[o.polygon_of(pair.vertex)];
    repairs.fill.push_back({std::move(hull), {}});
    repairs.are_hulls = true;
  }
  return result;
}

}  // namespace tetropolis
