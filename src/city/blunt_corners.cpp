#include "city/blunt_corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "city/grid_geometry.h"

namespace tetropolis {

namespace {

constexpr double kSharpTangent = 0.2679491924311227;  // of 15 degrees

/// The ends of the cut through the corner c between p-c and c-q, or nothing.
std::optional<std::pair<Point2, Point2>> cut(Point2 before, Point2 p, Point2 c, Point2 q,
                                             Point2 after, double distance) {
  const double lp = grid::distance(p, c), lq = grid::distance(q, c);
  const Point2 u{(p.x - c.x) / lp, (p.y - c.y) / lp}, v{(q.x - c.x) / lq, (q.y - c.y) / lq};
  const double cross = u.x * v.y - u.y * v.x, dot = u.x * v.x + u.y * v.y;
  if (!(dot > 0 && std::abs(cross) < kSharpTangent * dot)) return std::nullopt;
  const double from_tip = distance / std::hypot(u.x - v.x, u.y - v.y);
  if (!(from_tip + distance <= std::min(lp, lq))) return std::nullopt;
  const Point2 a = grid::rounded({c.x + from_tip * u.x, c.y + from_tip * u.y});
  const Point2 b = grid::rounded({c.x + from_tip * v.x, c.y + from_tip * v.y});
  if (grid::point_segment_distance(a, before, p) < distance ||
      grid::point_segment_distance(b, q, after) < distance)
    return std::nullopt;
  return std::pair{a, b};
}

std::int64_t blunt(Ring& ring, double distance) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::size_t n = ring.size();
    const auto at = [&](std::size_t k) {
      return ring[(i + n + k - 2) % n];
    };  // at(2) is the corner
    const auto ends = cut(at(0), at(1), at(2), at(3), at(4), distance);
    if (!ends) continue;
    ring[i] = ends->first;
    ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(i) + 1, ends->second);
    ++i;
    ++count;
  }
  return count;
}

}  // namespace

std::int64_t blunt_corners(Polygon& polygon, double distance) {
  std::int64_t count = blunt(polygon.outer, distance);
  for (Ring& hole : polygon.holes) count += blunt(hole, distance);
  return count;
}

}  // namespace tetropolis
