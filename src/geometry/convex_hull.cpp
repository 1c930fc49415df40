#include "convex_hull.h"

#include <algorithm>
#include <cstddef>

#include "predicates.h"

namespace tetropolis {

Ring convex_hull(Ring points) {
  std::sort(points.begin(), points.end(),
            [](Point2 a, Point2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Ring hull(2 * points.size());
  std::size_t n = 0;
  const auto add = [&](Point2 p, std::size_t floor) {
    while (n >= floor + 2 && orient2d(hull[n - 2], hull[n - 1], p) <= 0) --n;
    hull[n++] = p;
  };
  for (const Point2 p : points) add(p, 0);
  const std::size_t lower = n - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.resize(n - 1);
  return hull;
}

}  // namespace tetropolis
