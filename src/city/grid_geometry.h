// Exact decisions on grid points: coordinates are whole numbers of kCoordinateStep held in doubles
// ("steps"). Everything that cleans and simplifies footprints works in steps inside and converts at
// its borders, so that no decision about crossing or side depends on rounding.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis::grid {

/// Steps per metre.
inline constexpr double kSteps = kStepsPerMetre;
inline constexpr double kSquareMetre = kSteps * kSteps;

/// Largest magnitude of a coordinate in metres for which the predicates below are exact.
inline constexpr double kMaxCoordinate = 1e9;

inline Point2 to_steps(Point2 p) {
  return {std::nearbyint(p.x * kSteps), std::nearbyint(p.y * kSteps)};
}
/// The same bits as snap_coordinate() of the point in metres.
inline Point2 to_metres(Point2 p) { return {p.x / kSteps, p.y / kSteps}; }
inline Point2 rounded(Point2 p) { return {std::nearbyint(p.x), std::nearbyint(p.y)}; }

Polygon to_steps(const Polygon& polygon);
Polygon to_metres(const Polygon& polygon);

/// Sign of the area of the triangle a, b, c: 1 where c lies left of a to b, 0 on the line. Exact
/// for grid points within kMaxCoordinate: differences are exact in double; products, where the
/// rounding bound of their difference does not decide, are recomputed in 128 bits.
inline int orientation(Point2 a, Point2 b, Point2 c) {
  __extension__ using Wide = __int128;
  const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
  const double left = ux * vy, right = uy * vx;
  const double det = left - right;
  const double bound = 4.5e-16 * (std::abs(left) + std::abs(right));
  if (det > bound) return 1;
  if (det < -bound) return -1;
  const Wide exact = static_cast<Wide>(static_cast<long long>(ux)) * static_cast<long long>(vy) -
                     static_cast<Wide>(static_cast<long long>(uy)) * static_cast<long long>(vx);
  return exact > 0 ? 1 : (exact < 0 ? -1 : 0);
}

inline double dot(Point2 o, Point2 a, Point2 b) {
  return (a.x - o.x) * (b.x - o.x) + (a.y - o.y) * (b.y - o.y);
}

inline double squared_distance(Point2 a, Point2 b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

inline double distance(Point2 a, Point2 b) { return std::sqrt(squared_distance(a, b)); }

/// Twice the unsigned area of a triangle.
inline double twice_area(Point2 a, Point2 b, Point2 c) {
  return std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

using tetropolis::nearest_on_segment;
using tetropolis::squared_distance_to_segment;

inline double point_segment_distance(Point2 p, Point2 a, Point2 b) {
  return grid::distance(p, nearest_on_segment(p, a, b));
}

/// Whether c, known to be on the line a-b, is within the segment.
inline bool within_box(Point2 c, Point2 a, Point2 b) {
  return c.x >= std::min(a.x, b.x) && c.x <= std::max(a.x, b.x) && c.y >= std::min(a.y, b.y) &&
         c.y <= std::max(a.y, b.y);
}

/// Whether the closed segments a-b and c-d have a point in common. Exact.
inline bool segments_touch(Point2 a, Point2 b, Point2 c, Point2 d) {
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
    return false;
  const int o1 = orientation(a, b, c), o2 = orientation(a, b, d);
  if (o1 * o2 > 0) return false;
  const int o3 = orientation(c, d, a), o4 = orientation(c, d, b);
  if (o3 * o4 > 0) return false;
  if (o1 != 0 || o2 != 0 || o3 != 0 || o4 != 0) {
    if (o1 * o2 < 0 && o3 * o4 < 0) return true;
    return (o1 == 0 && within_box(c, a, b)) || (o2 == 0 && within_box(d, a, b)) ||
           (o3 == 0 && within_box(a, c, d)) || (o4 == 0 && within_box(b, c, d));
  }
  return within_box(c, a, b) || within_box(d, a, b) || within_box(a, c, d);
}

/// On which side of p the edge a-b crosses the line through p along x: 1 to the right, -1 to the
/// left, 0 on neither, where it runs through p or does not cross. The ends count as if they lay a
/// little lower. Exact, and the same for b-a. A point on no edge is inside by the even-odd rule
/// where an odd number of edges cross to one side, either one.
inline int crossing_side(Point2 a, Point2 b, Point2 p) {
  if ((a.y > p.y) == (b.y > p.y)) return 0;
  return a.y < b.y ? orientation(a, b, p) : orientation(b, a, p);
}

/// Whether p, which is on no edge, is inside the ring by the even-odd rule. Exact.
inline bool is_inside(std::span<const Point2> ring, Point2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if (crossing_side(ring[j], ring[i], p) > 0) inside = !inside;
  return inside;
}

/// Whether the segments o-a and o-b overlap beyond their common end o. Exact.
inline bool folds_back(Point2 o, Point2 a, Point2 b) {
  if (orientation(o, a, b) != 0) return false;
  // On one line: the same direction shows in the larger component, whose sign is exact.
  const double ax = a.x - o.x, ay = a.y - o.y, bx = b.x - o.x, by = b.y - o.y;
  return ax * bx > 0 || ay * by > 0;
}

inline double segment_distance(Point2 a, Point2 b, Point2 c, Point2 d) {
  if (segments_touch(a, b, c, d)) return 0;
  return std::min(std::min(point_segment_distance(a, c, d), point_segment_distance(b, c, d)),
                  std::min(point_segment_distance(c, a, b), point_segment_distance(d, a, b)));
}

inline Bounds2 box_of(Point2 a, Point2 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

/// Whether the segments a-b and c-d are closer than `distance`. Most that are not have boxes that
/// are not.
inline bool are_near(Point2 a, Point2 b, Point2 c, Point2 d, double distance) {
  return box_of(a, b).grown(distance).intersects(box_of(c, d)) &&
         segment_distance(a, b, c, d) < distance;
}

/// Of the outer rings; empty without any vertex.
inline Bounds2 box_around(std::span<const Polygon> polygons) {
  Bounds2 box = Bounds2::nothing();
  for (const Polygon& polygon : polygons)
    for (const Point2 p : polygon.outer) box.extend(p);
  return box;
}

}  // namespace tetropolis::grid
