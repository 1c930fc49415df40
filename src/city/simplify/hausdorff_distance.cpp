#include "hausdorff_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "city/edge_grid.h"
#include "city/grid_geometry.h"
#include "core/infinity.h"

namespace tetropolis {

namespace {

/// Twice the area of the triangle o, a, b; positive where b lies left of o to a.
double cross(Point2 o, Point2 a, Point2 b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

struct Wall {
  Point2 a;
  Point2 b;
  double distance_to(Point2 p) const { return grid::point_segment_distance(p, a, b); }
};

/// A region that can be asked for its nearest edge and whether it contains a point.
class Region {
 public:
  explicit Region(std::span<const Polygon> polygons) {
    for (const Polygon& polygon : polygons)
      for_each_ring(polygon, [&](const Ring& ring) { add(ring); });
    double length = 0;
    for (const Wall& wall : walls_) length += grid::distance(wall.a, wall.b);
    cell_ = cell_size(box_, length, walls_.size()) + 1;
    index_ = EdgeGrid(box_, cell_, walls_.size());
    for (const LineIndex e : indices<LineIndex>(walls_.size()))
      index_.insert(e, walls_[e].a, walls_[e].b);
  }

  /// Precondition: there are edges.
  std::size_t nearest(Point2 p) const {
    LineIndex best = LineIndex::none();
    double least = kInfinity;
    for (double reach = cell_ / 2;; reach = std::min(2 * reach, least)) {
      index_.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(reach), [&](LineIndex e) {
        const double d = walls_[e].distance_to(p);
        if (d < least || (d == least && e < best)) {
          least = d;
          best = e;
        }
      });
      if (least <= reach) return best;
    }
  }
  const Wall& wall(std::size_t e) const { return walls_[e]; }

  /// Whether a wall, or part of one, lies in the inside of a box.
  bool has_walls_in(const Bounds2& box) const {
    bool found = false;
    index_.visit(box, [&](LineIndex e) { found = found || crosses(walls_[e], box); });
    return found;
  }

  /// Whether a point is inside, whose nearest edge is e.
  bool contains(Point2 p, std::size_t e) const {
    const Wall& wall = walls_[e];
    const Point2 q = grid::nearest_on_segment(p, wall.a, wall.b);
    if (q == wall.a || q == wall.b) return beside_corner(p, q);
    return cross(wall.a, wall.b, p) > 0;
  }
  /// Whether a point is inside, or within a step of it.
  bool holds(Point2 p) const {
    const std::size_t e = nearest(p);
    return walls_[e].distance_to(p) <= 1 || contains(p, e);
  }

 private:
  void add(const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      walls_.push_back({ring[i], ring[(i + 1) % ring.size()]});
      box_.extend(ring[i]);
    }
  }
  /// By separating axes: those of the box, and the one across the wall.
  static bool crosses(const Wall& wall, const Bounds2& box) {
    const auto [left, right] = std::minmax(wall.a.x, wall.b.x);
    const auto [low, high] = std::minmax(wall.a.y, wall.b.y);
    if (right <= box.xmin || left >= box.xmax || high <= box.ymin || low >= box.ymax) return false;
    int sides = 0;
    for (const Point2 corner : {Point2{box.xmin, box.ymin}, Point2{box.xmax, box.ymin},
                                Point2{box.xmax, box.ymax}, Point2{box.xmin, box.ymax}})
      sides += cross(wall.a, wall.b, corner) > 0 ? 1 : -1;
    return std::abs(sides) < 4;
  }
  /// Whether a point is inside whose nearest point of the boundary is the vertex v. Of all walls
  /// that meet there, of however many rings, the one next to the point by angle decides.
  bool beside_corner(Point2 p, Point2 v) const {
    double least = kInfinity;
    bool inside = false;
    const auto look_along = [&](Point2 end, bool leaves) {
      if (end == v) return;
      const double turn = std::atan2(cross(v, p, end), grid::dot(v, p, end));
      if (!(std::abs(turn) < least)) return;
      least = std::abs(turn);
      inside = leaves == (turn <= 0);
    };
    index_.visit(grid::box_of(v, v), [&](LineIndex k) {
      const Wall& wall = walls_[k];
      if (grid::orientation(wall.a, wall.b, v) != 0 || !grid::within_box(v, wall.a, wall.b)) return;
      look_along(wall.b, true);
      look_along(wall.a, false);
    });
    return inside;
  }

  std::vector<Wall> walls_;
  Bounds2 box_ = Bounds2::nothing();
  double cell_ = 1;
  EdgeGrid index_;
};

Point2 middle(Point2 p, Point2 q) { return {(p.x + q.x) / 2, (p.y + q.y) / 2}; }

/// Corners in order around.
using Quad = std::array<Point2, 4>;

double farthest_corner(const Quad& quad, const Wall& wall) {
  double farthest = 0;
  for (const Point2 p : quad) farthest = std::max(farthest, wall.distance_to(p));
  return farthest;
}

using Parts = std::pair<Quad, Quad>;

/// The parts on either side of the line from m on side 0-1 to n on side 2-3, or, if not
/// `first_sides`, from m on side 1-2 to n on side 3-0.
Parts parts(const Quad& q, bool first_sides, Point2 m, Point2 n) {
  if (first_sides) return {{q[0], m, n, q[3]}, {m, q[1], q[2], n}};
  return {{q[0], q[1], m, n}, {n, m, q[2], q[3]}};
}

Parts halves(const Quad& q, bool first_sides) {
  return first_sides ? parts(q, true, middle(q[0], q[1]), middle(q[2], q[3]))
                     : parts(q, false, middle(q[1], q[2]), middle(q[3], q[0]));
}

/// The parts on either side of a wall's line, if that passes two opposite sides, and no corner by
/// less than a step.
std::optional<Parts> parts_along(const Quad& q, const Wall& wall) {
  std::array<double, 4> off{};  // from the line, to its left
  const double length = grid::distance(wall.a, wall.b);
  for (std::size_t i = 0; i < 4; ++i) {
    off[i] = cross(wall.a, wall.b, q[i]) / length;
    if (!(std::abs(off[i]) >= 1)) return std::nullopt;
  }
  const auto on_side = [&](std::size_t i, std::size_t j) {
    const double t = off[i] / (off[i] - off[j]);
    return Point2{q[i].x + t * (q[j].x - q[i].x), q[i].y + t * (q[j].y - q[i].y)};
  };
  const bool left0 = off[0] > 0, left1 = off[1] > 0, left2 = off[2] > 0, left3 = off[3] > 0;
  if (left0 == left3 && left1 == left2 && left0 != left1)
    return parts(q, true, on_side(0, 1), on_side(2, 3));
  if (left0 == left1 && left2 == left3 && left1 != left2)
    return parts(q, false, on_side(1, 2), on_side(3, 0));
  return std::nullopt;
}

/// What a strip's distances cannot exceed by its own sides, where these belong to the other region.
double bound_by_sides(const DifferenceStrip& s) {
  double bound = kInfinity;
  for (const DifferenceEdge* side : {&s.left, &s.right})
    if (side->of_after != s.in_after)
      bound = std::min(bound, farthest_corner(s.corners, {side->a, side->b}));
  return bound;
}

/// Looks for the point of region `own` that is farthest from region `other`.
class Search {
 public:
  Search(const Region& own, const Region& other, double tolerance, HausdorffDistance& best)
      : own_(own), other_(other), tolerance_(tolerance), best_(best) {}

  void strip(const DifferenceStrip& s) {
    stack_.assign(1, s.corners);
    while (!stack_.empty()) {
      const Quad quad = stack_.back();
      stack_.pop_back();
      divide(quad);
    }
  }

 private:
  /// The other region's nearest wall, after trying the point.
  std::size_t look_at(Point2 p) {
    const std::size_t e = other_.nearest(p);
    const double d = other_.wall(e).distance_to(p);
    if (d > best_.distance && !other_.contains(p, e) && own_.holds(p)) best_ = {d, p};
    return e;
  }
  bool is_elsewhere(const Quad& quad, Point2 centre, std::size_t nearest) const;
  void divide(const Quad& quad);

  const Region& own_;
  const Region& other_;
  double tolerance_;
  HausdorffDistance& best_;
  std::vector<Quad> stack_;
};

/// Whether all of a quad is in the other region, or none of it in its own: strips also cover what
/// lies inside pieces, and between them. A step at its sides, where walls may run, does not matter.
/// `nearest`: the other region's wall nearest to the centre.
bool Search::is_elsewhere(const Quad& quad, Point2 centre, std::size_t nearest) const {
  Bounds2 box = Bounds2::nothing();
  for (const Point2 p : quad) box.extend(p);
  box = box.grown(-1);
  if (box.xmin >= box.xmax || box.ymin >= box.ymax) return false;
  if (other_.contains(centre, nearest) && !other_.has_walls_in(box)) return true;
  return !own_.has_walls_in(box) && !own_.contains(centre, own_.nearest(centre));
}

void Search::divide(const Quad& quad) {
  const Point2 centre = middle(middle(quad[0], quad[1]), middle(quad[2], quad[3]));
  double radius = 0;
  for (const Point2 p : quad) radius = std::max(radius, grid::distance(p, centre));
  const std::size_t nearest = look_at(centre);
  std::array<const Wall*, 5> walls{&other_.wall(nearest)};
  double bound = std::min(walls[0]->distance_to(centre) + radius, farthest_corner(quad, *walls[0]));
  if (bound <= best_.distance + tolerance_ || is_elsewhere(quad, centre, nearest)) return;
  for (std::size_t i = 0; i < 4; ++i) {
    walls[i + 1] = &other_.wall(look_at(quad[i]));
    bound = std::min(bound, farthest_corner(quad, *walls[i + 1]));
  }
  if (bound <= best_.distance + tolerance_ || radius < tolerance_) return;
  // Inside the other region nothing is far from it, so parts should end at its walls.
  if (const std::optional<Parts> cut = parts_along(quad, *walls[0])) {
    stack_.push_back(cut->first);
    stack_.push_back(cut->second);
    return;
  }
  // Halved the way that promises more.
  std::array<Parts, 2> ways{halves(quad, true), halves(quad, false)};
  std::array<double, 2> promise{};
  for (std::size_t w = 0; w < 2; ++w)
    for (const Quad* half : {&ways[w].first, &ways[w].second}) {
      double least = kInfinity;
      for (const Wall* wall : walls) least = std::min(least, farthest_corner(*half, *wall));
      promise[w] = std::max(promise[w], least);
    }
  const double side01 = grid::squared_distance(quad[0], quad[1]),
               side12 = grid::squared_distance(quad[1], quad[2]);
  bool first = promise[0] < promise[1] || (promise[0] == promise[1] && side01 >= side12);
  // But only where there is something to halve: slivers would stay what they are for ever.
  const double least = 0.25 * tolerance_ * tolerance_;
  if (std::max(side01, grid::squared_distance(quad[2], quad[3])) < least) first = false;
  if (std::max(side12, grid::squared_distance(quad[3], quad[0])) < least) first = true;
  const auto& [p, q] = ways[first ? 0 : 1];
  stack_.push_back(p);
  stack_.push_back(q);
}

}  // namespace

HausdorffDistance hausdorff_distance(std::span<const Polygon> before,
                                     std::span<const Polygon> after,
                                     std::span<const DifferenceStrip> strips, double tolerance) {
  HausdorffDistance best;
  if (strips.empty() || before.empty() || after.empty()) return best;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < strips.size(); ++i) order.emplace_back(-bound_by_sides(strips[i]), i);
  std::sort(order.begin(), order.end());
  const Region from(before), to(after);
  Search in_before(from, to, tolerance, best), in_after(to, from, tolerance, best);
  for (const auto& [bound, i] : order) {
    if (-bound <= best.distance + tolerance) continue;
    (strips[i].in_after ? in_after : in_before).strip(strips[i]);
  }
  return best;
}

}  // namespace tetropolis
