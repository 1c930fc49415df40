#include "city/merge_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "city/outline.h"
#include "city/overlay.h"
#include "core/disjoint_sets.h"

namespace tetropolis {

namespace {

/// Sets of `size` things, of which body(begin, end, sets) joins those that it finds in a chunk of
/// [0, work): in sets of its own, which are put together afterwards. Which sets come out depends on
/// no order.
template <typename Body>
void join_in_chunks(std::size_t work, std::size_t size, DisjointSets& sets, const Body& body) {
  constexpr std::size_t kChunks = 8;  // each costs a list of all things, or of all edges
  const std::size_t grain = std::max<std::size_t>(grain_of_chunks(work, kChunks), 256);
  std::vector<DisjointSets> found((work + grain - 1) / grain, DisjointSets(0));
  parallel_chunks(work, grain, [&](std::size_t begin, std::size_t end) {
    DisjointSets local(size);
    body(static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end), local);
    found[begin / grain] = std::move(local);
  });
  for (DisjointSets& local : found)
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(size); ++i)
      if (const std::int32_t root = local.root(i); root != i) sets.join(root, i);
}

void join_near_edges(const Outline& o, double distance, std::size_t polygons, DisjointSets& sets) {
  std::vector<std::int32_t> group(o.point.size());
  for (std::int32_t e = 0; e < o.vertex_count(); ++e)
    group[static_cast<std::size_t>(e)] = o.group_of(e);
  const auto join = [&](std::int32_t begin, std::int32_t end, DisjointSets& local) {
    for (std::int32_t e = begin; e < end; ++e) {
      const Point2 a = o.at(e), b = o.at(o.after(e));
      std::int32_t root = local.root(group[static_cast<std::size_t>(e)]);
      o.grid.visit(grid::box_of(a, b).grown(distance), [&](std::int32_t f) {
        if (f <= e) return;
        // Where many overlap, nearly all pairs are joined already: that has to be seen at once.
        const std::int32_t other = group[static_cast<std::size_t>(f)];
        if (local.root(other) == root) return;
        if (!(grid::segment_distance(a, b, o.at(f), o.at(o.after(f))) < distance)) return;
        local.join(root, other);
        root = local.root(root);
      });
    }
  };
  join_in_chunks(o.point.size(), polygons, sets, join);
}

/// Joins polygons to those that contain them: even-odd count, per other polygon, of the edges left
/// of a vertex. Boundaries of polygons not yet joined are apart, so any vertex will do.
void join_contained(const Outline& o, std::span<const Polygon> polygons, DisjointSets& sets) {
  double widest = 0;
  std::vector<Bounds2> boxes;
  boxes.reserve(polygons.size());
  for (const Polygon& polygon : polygons) {
    boxes.push_back(bounds(polygon));
    widest = std::max(widest, boxes.back().width());
  }
  const auto join = [&](std::int32_t begin, std::int32_t end, DisjointSets& local) {
    std::vector<std::int32_t> seen(o.point.size(), -1);
    std::vector<std::int32_t> crossed;
    for (std::int32_t r = begin; r < end; ++r) {
      const auto ring = static_cast<std::size_t>(r);
      if (o.is_hole[ring] != 0) continue;
      const Point2 p = o.at(o.first[ring]);
      crossed.clear();
      o.grid.visit({p.x - widest, p.y, p.x, p.y}, [&](std::int32_t e) {
        if (seen[static_cast<std::size_t>(e)] == r) return;
        seen[static_cast<std::size_t>(e)] = r;
        // Of polygons around p the search sees all edges left of p; of others perhaps not.
        if (!boxes[static_cast<std::size_t>(o.group_of(e))].contains(p)) return;
        if (grid::crossing_side(o.at(e), o.at(o.after(e)), p) < 0) crossed.push_back(o.group_of(e));
      });
      std::sort(crossed.begin(), crossed.end());
      for (std::size_t i = 0; i < crossed.size();) {
        std::size_t j = i;
        while (j < crossed.size() && crossed[j] == crossed[i]) ++j;
        if ((j - i) % 2 == 1) local.join(o.group[ring], crossed[i]);
        i = j;
      }
    }
  };
  join_in_chunks(o.first.size(), polygons.size(), sets, join);
}

/// The share [t0, t1] of a-b within `reach` of c-d; empty (t0 > t1) if none is. The distance to a
/// segment is a convex function along a-b, so both ends are found by bisection from its minimum.
std::pair<double, double> part_within(Point2 a, Point2 b, Point2 c, Point2 d, double reach) {
  const auto at = [&](double t) { return Point2{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; };
  const auto f = [&](double t) { return grid::point_segment_distance(at(t), c, d); };
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double t1 = low + (high - low) / 3, t2 = high - (high - low) / 3;
    if (f(t1) <= f(t2))
      high = t2;
    else
      low = t1;
  }
  double best = (low + high) / 2;
  if (f(0) <= f(best)) best = 0;
  if (f(1) < f(best)) best = 1;
  if (f(best) > reach) return {1, 0};
  const auto end = [&](double outside) {
    if (f(outside) <= reach) return outside;
    double inside = best;
    for (int i = 0; i < 50; ++i) {
      const double middle = (inside + outside) / 2;
      (f(middle) <= reach ? inside : outside) = middle;
    }
    return inside;
  };
  return {end(0), end(1)};
}

using EdgePair = std::pair<std::int32_t, std::int32_t>;

/// Whether e is near f only with one end, from which another edge faces f: the patch between that
/// one and f closes the gap, and one between e and f would round off the corner only.
bool passed_over(const Outline& o, const std::vector<EdgePair>& pairs, std::int32_t e,
                 std::int32_t f, double distance) {
  const Point2 a = o.at(e), b = o.at(o.after(e)), c = o.at(f), d = o.at(o.after(f));
  if (edges_face(a, b, c, d, distance)) return false;
  const bool at_start =
      grid::point_segment_distance(a, c, d) <= grid::point_segment_distance(b, c, d);
  const std::int32_t other = at_start ? o.before(e) : o.after(e);
  return std::binary_search(pairs.begin(), pairs.end(),
                            EdgePair{std::min(other, f), std::max(other, f)}) &&
         edges_face(o.at(other), o.at(o.after(other)), c, d, distance);
}

std::vector<EdgePair> pairs_between(const Outline& o, double distance) {
  std::vector<EdgePair> pairs;
  for (std::int32_t e = 0; e < o.vertex_count(); ++e) {
    const Point2 a = o.at(e), b = o.at(o.after(e));
    o.grid.visit(grid::box_of(a, b).grown(distance), [&](std::int32_t f) {
      if (f <= e || o.group_of(e) == o.group_of(f)) return;
      if (grid::segment_distance(a, b, o.at(f), o.at(o.after(f))) < distance)
        pairs.emplace_back(e, f);
    });
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

std::vector<Polygon> patches_between(std::span<const Polygon> parts, double distance,
                                     double reach) {
  const Outline o = outline_for(pointers_to(parts), distance);
  const std::vector<EdgePair> pairs = pairs_between(o, distance);
  std::vector<Polygon> patches;
  for (const auto& [e, f] : pairs) {
    if (passed_over(o, pairs, e, f, distance) || passed_over(o, pairs, f, e, distance)) continue;
    Ring patch = gap_patch(o.at(e), o.at(o.after(e)), o.at(f), o.at(o.after(f)), reach);
    if (!patch.empty()) patches.push_back({std::move(patch), {}});
  }
  return patches;
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
    std::int32_t i, j;  ///< Parts.
    double length;
    std::int32_t e, f;
  };
  std::vector<Bridge> bridges;
  for (const auto& [e, f] : pairs_between(o, distance)) {
    const auto [i, j] = std::minmax({o.group_of(e), o.group_of(f)});
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

Polygon hull_of(std::span<const Polygon> polygons) {
  Ring points;
  for (const Polygon& polygon : polygons)
    points.insert(points.end(), polygon.outer.begin(), polygon.outer.end());
  return {grid::convex_hull(std::move(points)), {}};
}

}  // namespace

std::vector<std::int32_t> cluster_polygons(std::span<const Polygon> polygons, double distance) {
  const Outline o = outline_for(pointers_to(polygons), distance);
  DisjointSets sets(polygons.size());
  join_near_edges(o, distance, polygons.size(), sets);
  join_contained(o, polygons, sets);
  std::vector<std::int32_t> cluster(polygons.size());
  std::int32_t count = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const auto root = static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(i)));
    cluster[i] = root == i ? count++ : cluster[root];
  }
  return cluster;
}

Polygon box_along(std::span<const Point2> points, Point2 from, Point2 to, double distance) {
  const double length = grid::distance(from, to);
  if (!(length > 0)) return {};
  const double ux = (to.x - from.x) / length, uy = (to.y - from.y) / length;
  Bounds2 box = Bounds2::nothing();
  for (const Point2 c : points)
    box.extend(Point2{(c.x - from.x) * ux + (c.y - from.y) * uy,
                      (c.y - from.y) * ux - (c.x - from.x) * uy});
  const double least = 1.1 * distance;
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

Ring gap_patch(Point2 a, Point2 b, Point2 c, Point2 d, double reach) {
  const auto [s0, s1] = part_within(a, b, c, d, reach);
  const auto [t0, t1] = part_within(c, d, a, b, reach);
  if (s0 > s1 || t0 > t1) return {};
  const auto on = [](Point2 p, Point2 q, double t) {
    if (t == 0) return p;
    if (t == 1) return q;
    return grid::rounded({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
  };
  Ring hull = grid::convex_hull({on(a, b, s0), on(a, b, s1), on(c, d, t0), on(c, d, t1)});
  // Less than a square centimetre comes of rounding along one line.
  if (hull.size() < 3 || signed_area(hull) < 1e4) return {};
  return hull;
}

bool edges_face(Point2 a, Point2 b, Point2 c, Point2 d, double distance) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = d.x - c.x, vy = d.y - c.y;
  const double lu = std::hypot(ux, uy), lv = std::hypot(vx, vy);
  if (!(lu > 0 && lv > 0) || std::abs(ux * vx + uy * vy) < 0.9 * lu * lv) return false;
  const auto along = [&](Point2 p) { return ((p.x - c.x) * vx + (p.y - c.y) * vy) / lv; };
  const auto off = [&](Point2 p) { return std::abs((p.x - c.x) * vy - (p.y - c.y) * vx) / lv; };
  const double shared =
      std::min(lv, std::max(along(a), along(b))) - std::max(0.0, std::min(along(a), along(b)));
  return shared > distance / 4 && std::max(off(a), off(b)) > 1;
}

MergedPolygon merge_polygons(std::span<const Polygon> cluster, double distance, int growths,
                             const Poll& poll) {
  MergedPolygon result;
  result.input.assign(cluster.begin(), cluster.end());
  if (cluster.size() > 1) result.input = unite_or_widest(cluster, poll);
  std::vector<Polygon> parts = result.input;
  double reach = distance * (1 + 1e-3);
  for (int k = 1; k <= std::max(growths, 1) && parts.size() > 1; ++k, reach *= 2) {
    const std::vector<Polygon> patches = patches_between(parts, distance, reach);
    if (!patches.empty()) parts = add_on_grid(parts, patches);
    result.method = MergeMethod::kPatch;
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
