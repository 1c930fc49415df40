// Distance in the plane, for the checks only. The same for everything that is measured here.
#pragma once

#include <algorithm>
#include <cmath>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// From p to the segment a-b, which may be a single point.
inline double segment_distance(Point2 p, Point2 a, Point2 b) {
  const double ux = b.x - a.x, uy = b.y - a.y, wx = p.x - a.x, wy = p.y - a.y;
  const double square = ux * ux + uy * uy;
  // In this order what is not a number becomes 0.
  const double t = square > 0 ? std::min(1.0, std::max(0.0, (wx * ux + wy * uy) / square)) : 0;
  return std::hypot(wx - t * ux, wy - t * uy);
}

}  // namespace tetropolis
