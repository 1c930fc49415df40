#include "city/roofs/sample_roofs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/infinity.h"

namespace tetropolis {

namespace {

/// Height of the plane at p; not finite where its points lie on one line.
double height_at(const StatedRoof& roof, Point2 p) {
  const auto from_first = [&](Point2 q) { return Point2{q.x - roof.at[0].x, q.y - roof.at[0].y}; };
  const Point2 u = from_first(roof.at[1]), v = from_first(roof.at[2]), d = from_first(p);
  const double det = u.x * v.y - u.y * v.x;
  const double a = (d.x * v.y - d.y * v.x) / det, b = (u.x * d.y - u.y * d.x) / det;
  return roof.height[0] + a * (roof.height[1] - roof.height[0]) +
         b * (roof.height[2] - roof.height[0]);
}

}  // namespace

std::vector<Point3> sample_roofs(std::span<const StatedRoof> roofs, const Polygon& footprint,
                                 double base) {
  constexpr double kStep = 0.5;
  std::vector<Bounds2> boxes;
  for (const StatedRoof& roof : roofs) boxes.push_back(bounds(roof.outline));
  const auto highest_at = [&](Point2 p) {
    double height = -kInfinity;
    for (std::size_t r = 0; r < roofs.size(); ++r)
      if (boxes[r].contains(p) && contains(roofs[r].outline, p))
        height = std::max(height, height_at(roofs[r], p));
    return height;
  };
  const Bounds2 box = bounds(footprint);
  const auto first = [](double low) { return std::ceil(low / kStep - 0.5); };
  std::vector<Point3> points;
  for (double j = first(box.ymin); (j + 0.5) * kStep <= box.ymax; ++j)
    for (double i = first(box.xmin); (i + 0.5) * kStep <= box.xmax; ++i) {
      const Point2 p{(i + 0.5) * kStep, (j + 0.5) * kStep};
      if (!contains(footprint, p)) continue;
      if (const double height = highest_at(p); std::isfinite(height))
        points.push_back({p.x, p.y, base + height});
    }
  return points;
}

}  // namespace tetropolis
