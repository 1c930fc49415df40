#include "tetropolis/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetropolis {

double signed_area(const Ring& ring) {
  if (ring.size() < 3) return 0;
  // Relative to the first vertex, so that large coordinates do not cancel.
  const Point2 o = ring[0];
  double twice = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    twice += (ring[i].x - o.x) * (ring[i + 1].y - o.y) - (ring[i + 1].x - o.x) * (ring[i].y - o.y);
  return twice / 2;
}

double area(const Polygon& polygon) {
  double result = std::abs(signed_area(polygon.outer));
  for (const Ring& hole : polygon.holes) result -= std::abs(signed_area(hole));
  return result;
}

Bounds2 bounds(const Ring& ring) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Bounds2 box{inf, inf, -inf, -inf};
  for (const Point2 p : ring) {
    box.xmin = std::min(box.xmin, p.x);
    box.ymin = std::min(box.ymin, p.y);
    box.xmax = std::max(box.xmax, p.x);
    box.ymax = std::max(box.ymax, p.y);
  }
  return box;
}

Bounds2 bounds(const Polygon& polygon) { return bounds(polygon.outer); }

bool contains(const Polygon& polygon, Point2 p) {
  bool inside = false;
  for_each_edge(polygon, [&](Point2 a, Point2 b) {
    if ((a.y > p.y) == (b.y > p.y)) return;
    // Evaluated from the lower to the upper end, whichever way the ring runs: two polygons that
    // share an edge take the same decision.
    if (a.y > b.y) std::swap(a, b);
    const double side = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
    if (side > 0) inside = !inside;
  });
  return inside;
}

double distance_to_segment(Point2 p, Point2 a, Point2 b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  double t = 0;
  if (length2 > 0) t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0);
  return std::hypot(p.x - (a.x + t * dx), p.y - (a.y + t * dy));
}

double distance_to_boundary(const Polygon& polygon, Point2 p) {
  double distance = std::numeric_limits<double>::infinity();
  for_each_edge(polygon, [&](Point2 a, Point2 b) {
    distance = std::min(distance, distance_to_segment(p, a, b));
  });
  return distance;
}

}  // namespace tetropolis
