#include "merge_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "city/outline.h"
#include "geometry/convex_hull.h"
#include "overlay.h"

namespace tetropolis {

namespace {

// Both leave less than a step of an edge of 1,000 km (10^10 steps): 2^50 is 10^15, 1.5^60 is
// 4 * 10^10.
constexpr int kHalves = 50, kThirds = 60;

/// The share [t0, t1] of a-b within `reach` of c-d; empty (t0 > t1) if none is. The distance to a
/// segment is a convex function along a-b, so both ends are found by bisection from an end of a-b
/// within reach or, without one, from its minimum.
std::pair<double, double> part_within(Point2 a, Point2 b, Point2 c, Point2 d, double reach) {
  const auto at = [&](double t) { return Point2{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; };
  const auto f = [&](double t) { return grid::point_segment_distance(at(t), c, d); };
  const auto is_within = [&](double t) { return f(t) <= reach; };
  const auto nearest = [&] {
    double low = 0, high = 1;
    for (int i = 0; i < kThirds; ++i) {
      const double t1 = low + (high - low) / 3, t2 = high - (high - low) / 3;
      if (f(t1) <= f(t2))
        high = t2;
      else
        low = t1;
    }
    return (low + high) / 2;
  };
  const auto end = [&](double inside, double outside) {
    for (int i = 0; i < kHalves; ++i) {
      const double middle = (inside + outside) / 2;
      (is_within(middle) ? inside : outside) = middle;
    }
    return inside;
  };
  const bool with_start = is_within(0), with_end = is_within(1);
  if (with_start && with_end) return {0, 1};
  if (with_start) return {0, end(0, 1)};
  if (with_end) return {end(1, 0), 1};
  const double best = nearest();
  if (!is_within(best)) return {1, 0};
  return {end(best, 0), end(best, 1)};
}

using EdgePair = std::pair<OutlineVertex, OutlineVertex>;

/// Whether e is near f only with one end, from which another edge faces f: the gap fill between
/// that one and f closes the gap, and one between e and f would round off the corner only.
bool passed_over(const Outline& o, const std::vector<EdgePair>& pairs, OutlineVertex e,
                 OutlineVertex f, double distance) {
  const Point2 a = o.at(e), b = o.at(o.after(e)), c = o.at(f), d = o.at(o.after(f));
  if (edges_face(a, b, c, d, distance)) return false;
  const bool at_start =
      grid::point_segment_distance(a, c, d) <= grid::point_segment_distance(b, c, d);
  const OutlineVertex other = at_start ? o.before(e) : o.after(e);
  return std::binary_search(pairs.begin(), pairs.end(),
                            EdgePair{std::min(other, f), std::max(other, f)}) &&
         edges_face(o.at(other), o.at(o.after(other)), c, d, distance);
}

/// Edges of different polygons that are closer than `distance`, ascending. None, not all of them,
/// if they are more than `most`.
std::optional<std::vector<EdgePair>> pairs_between(
    const Outline& o, double distance, std::size_t most = std::numeric_limits<std::size_t>::max()) {
  std::vector<EdgePair> pairs;
  for (const OutlineVertex e : o.vertices()) {
    const Point2 a = o.at(e), b = o.at(o.after(e));
    const auto own = static_cast<std::ptrdiff_t>(pairs.size());
    o.grid.visit_cells_near(a, b, distance, [&](std::size_t cell) {
      o.grid.visit_cell(cell, [&](OutlineVertex f) {
        if (f <= e || o.polygon_of(e) == o.polygon_of(f)) return;
        if (grid::are_near(a, b, o.at(f), o.at(o.after(f)), distance)) pairs.emplace_back(e, f);
      });
    });
    std::sort(pairs.begin() + own, pairs.end());
    pairs.erase(std::unique(pairs.begin() + own, pairs.end()), pairs.end());
    if (pairs.size() > most) return std::nullopt;
  }
  return pairs;
}

bool share_a_corner(const Outline& o, const EdgePair& pair) {
  const Point2 a = o.at(pair.first), b = o.at(o.after(pair.first));
  const Point2 c = o.at(pair.second), d = o.at(o.after(pair.second));
  return a == c || a == d || b == c || b == d;
}

/// Drops pairs of edges that start from one corner with others between them: what is near the two
/// is nearer to those, and their gaps are closed anyway.
void keep_next_at_corners(const Outline& o, std::vector<EdgePair>& pairs) {
  struct Spoke {
    Point2 corner, tip;
    OutlineVertex edge;
    bool is_upper() const { return tip.y > corner.y || (tip.y == corner.y && tip.x > corner.x); }
  };
  std::vector<Spoke> spokes;
  for (const OutlineVertex e : o.vertices()) {
    spokes.push_back({o.at(e), o.at(o.after(e)), e});
    spokes.push_back({o.at(o.after(e)), o.at(e), e});
  }
  const auto key = [](const Spoke& s) { return std::tuple{s.corner.x, s.corner.y, !s.is_upper()}; };
  std::sort(spokes.begin(), spokes.end(), [&](const Spoke& a, const Spoke& b) {
    if (key(a) != key(b)) return key(a) < key(b);
    const int side = grid::orientation(a.corner, a.tip, b.tip);
    return side != 0 ? side > 0 : a.edge < b.edge;
  });
  std::vector<EdgePair> next;
  const auto add = [&](const Spoke& a, const Spoke& b) {
    next.push_back(std::minmax(a.edge, b.edge));
  };
  for (auto begin = spokes.begin(); begin != spokes.end();) {
    const auto end = std::find_if(begin, spokes.end(),
                                  [&](const Spoke& s) { return s.corner != begin->corner; });
    for (auto s = begin; s != end; ++s) add(*s, s + 1 == end ? *begin : *(s + 1));
    begin = end;
  }
  std::sort(next.begin(), next.end());
  std::erase_if(pairs, [&](const EdgePair& pair) {
    return share_a_corner(o, pair) && !std::binary_search(next.begin(), next.end(), pair);
  });
}

/// The polygons with gap fills in the gaps between them that are narrower than `distance`. Where
/// each is near very many others, narrower gaps are closed first, so that most of these pairs,
/// which others lie between, never get a gap fill.
std::vector<Polygon> with_gaps_closed(std::vector<Polygon> parts, double distance, double reach,
                                      const Poll& poll) {
  // Edges of ordinary cities have one or two near others; few pairs are quick in any case.
  constexpr std::size_t kCrowd = 8, kFewPairs = 2000;
  constexpr double kFinest = 0.01 * grid::kSteps;  // a centimetre: what is nearer is a crack
  if (poll) poll();
  Outline o = outline_for(pointers_to(parts), distance);
  std::optional<std::vector<EdgePair>> pairs;
  if (distance > kFinest) pairs = pairs_between(o, distance, kCrowd * o.point.size() + kFewPairs);
  if (!pairs) {
    if (distance > kFinest) {
      parts = with_gaps_closed(std::move(parts), distance / 2, reach / 2, poll);
      o = outline_for(pointers_to(parts), distance);
    }
    pairs = pairs_between(o, distance);
    keep_next_at_corners(o, *pairs);
  }
  std::vector<Polygon> fills;
  for (const auto& [e, f] : *pairs) {
    if (passed_over(o, *pairs, e, f, distance) || passed_over(o, *pairs, f, e, distance)) continue;
    Ring fill = gap_fill(o.at(e), o.at(o.after(e)), o.at(f), o.at(o.after(f)), reach);
    if (!fill.empty()) fills.push_back({std::move(fill), {}});
  }
  return fills.empty() ? parts : add_on_grid(parts, fills);
}

/// The shortest way between two segments.
std::pair<Point2, Point2> shortest_way(Point2 a, Point2 b, Point2 c, Point2 d) {
  std::pair<Point2, Point2> best{a, grid::nearest_on_segment(a, c, d)};
  const auto consider = [&](Point2 p, Point2 q) {
    if (grid::squared_distance(p, q) < grid::squared_distance(best.first, best.second))
      best = {p, q};
  };
  consider(b, grid::nearest_on_segment(b, c, d));
  consider(grid::nearest_on_segment(c, a, b), c);
  consider(grid::nearest_on_segment(d, a, b), d);
  return best;
}

/// Boxes a little wider than `distance` across the narrowest place between every two near parts.
std::vector<Polygon> bridges_between(std::span<const Polygon> parts, double distance) {
  const Outline o = outline_for(pointers_to(parts), distance);
  struct Bridge {
    OutlinePolygon i, j;  ///< Parts.
    double length;
    OutlineVertex e, f;
  };
  std::vector<Bridge> bridges;
  const auto pairs = pairs_between(o, distance);
  for (const auto& [e, f] : *pairs) {
    const auto [i, j] = std::minmax({o.polygon_of(e), o.polygon_of(f)});
    bridges.push_back(
        {i, j, grid::segment_distance(o.at(e), o.at(o.after(e)), o.at(f), o.at(o.after(f))), e, f});
  }
  std::stable_sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
    return std::tie(a.i, a.j, a.length) < std::tie(b.i, b.j, b.length);
  });
  std::vector<Polygon> boxes;
  for (std::size_t k = 0; k < bridges.size(); ++k) {
    const Bridge& bridge = bridges[k];
    if (k > 0 && bridges[k - 1].i == bridge.i && bridges[k - 1].j == bridge.j) continue;
    Point2 a = o.at(bridge.e), b = o.at(o.after(bridge.e));
    Point2 c = o.at(bridge.f), d = o.at(o.after(bridge.f));
    const auto [p, q] = shortest_way(a, b, c, d);
    if (grid::squared_distance(c, d) > grid::squared_distance(a, b)) {
      a = c;
      b = d;
    }
    boxes.push_back(box_along(std::array{p, q}, a, b, distance));
  }
  return boxes;
}

/// Width of a box at least, in clearances: with rounded corners and at any angle it stays wider
/// than one.
constexpr double kBoxWidth = 1.1;

Polygon hull_of(std::span<const Polygon> polygons) {
  Ring points;
  for (const Polygon& polygon : polygons)
    points.insert(points.end(), polygon.outer.begin(), polygon.outer.end());
  return {convex_hull(std::move(points)), {}};
}

}  // namespace

Polygon box_along(std::span<const Point2> points, Point2 from, Point2 to, double distance) {
  const double length = grid::distance(from, to);
  if (!(length > 0)) return {};
  const double ux = (to.x - from.x) / length, uy = (to.y - from.y) / length;
  Bounds2 box = Bounds2::nothing();
  for (const Point2 c : points)
    box.extend(Point2{(c.x - from.x) * ux + (c.y - from.y) * uy,
                      (c.y - from.y) * ux - (c.x - from.x) * uy});
  const double least = kBoxWidth * distance;
  const double along = std::max(0.0, least - box.width()) / 2;
  const double across = std::max(0.0, least - box.height()) / 2;
  const auto corner = [&](double t, double n) {
    return grid::rounded({from.x + t * ux - n * uy, from.y + t * uy + n * ux});
  };
  return {
      {corner(box.xmin - along, box.ymin - across), corner(box.xmax + along, box.ymin - across),
       corner(box.xmax + along, box.ymax + across), corner(box.xmin - along, box.ymax + across)},
      {}};
}

Ring gap_fill(Point2 a, Point2 b, Point2 c, Point2 d, double reach) {
  const auto [s0, s1] = part_within(a, b, c, d, reach);
  const auto [t0, t1] = part_within(c, d, a, b, reach);
  if (s0 > s1 || t0 > t1) return {};
  const auto on = [](Point2 p, Point2 q, double t) {
    if (t == 0) return p;
    if (t == 1) return q;
    return grid::rounded({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
  };
  Ring hull = convex_hull({on(a, b, s0), on(a, b, s1), on(c, d, t0), on(c, d, t1)});
  constexpr double kLeastArea = 1e4;  // a square centimetre: less comes of rounding along one line
  if (hull.size() < 3 || signed_area(hull) < kLeastArea) return {};
  return hull;
}

bool edges_face(Point2 a, Point2 b, Point2 c, Point2 d, double distance) {
  constexpr double kParallel = 0.9;      // cosine: up to 26 degrees apart
  constexpr double kLeastShared = 0.25;  // of `distance`: less is a corner, not a side
  constexpr double kOnOneLine = 1;       // step: what rounding leaves between edges on one line
  const double ux = b.x - a.x, uy = b.y - a.y, vx = d.x - c.x, vy = d.y - c.y;
  const double lu = std::hypot(ux, uy), lv = std::hypot(vx, vy);
  if (!(lu > 0 && lv > 0) || std::abs(ux * vx + uy * vy) < kParallel * lu * lv) return false;
  const auto along = [&](Point2 p) { return ((p.x - c.x) * vx + (p.y - c.y) * vy) / lv; };
  const auto off = [&](Point2 p) { return std::abs((p.x - c.x) * vy - (p.y - c.y) * vx) / lv; };
  const double shared =
      std::min(lv, std::max(along(a), along(b))) - std::max(0.0, std::min(along(a), along(b)));
  return shared > kLeastShared * distance && std::max(off(a), off(b)) > kOnOneLine;
}

MergedPolygon merge_polygons(std::span<const Polygon> cluster, double distance, int growths,
                             const Poll& poll) {
  MergedPolygon result;
  result.input.assign(cluster.begin(), cluster.end());
  if (cluster.size() > 1) result.input = unite_or_largest(cluster, poll);
  std::vector<Polygon> parts = result.input;
  double reach = distance * (1 + 1e-3);  // so that the ends of gap fills are not at the limit
  for (int k = 1; k <= std::max(growths, 1) && parts.size() > 1; ++k, reach *= 2) {
    parts = with_gaps_closed(std::move(parts), distance, reach, poll);
    result.method = MergeMethod::kGapFill;
    result.growths = k;
  }
  if (parts.size() > 1) {
    const std::vector<Polygon> bridges = bridges_between(parts, distance);
    if (!bridges.empty()) parts = add_on_grid(parts, bridges);
    result.method = MergeMethod::kBridge;
  }
  if (parts.size() > 1) {
    for (const Polygon& part : std::vector<Polygon>(parts)) parts.push_back(hull_of({&part, 1}));
    parts = unite_on_grid(parts);
    result.method = MergeMethod::kUnionOfHulls;
  }
  if (parts.size() > 1) {
    parts = {hull_of(parts)};
    result.method = MergeMethod::kHull;
  }
  result.polygon = std::move(parts[0]);
  return result;
}

}  // namespace tetropolis
