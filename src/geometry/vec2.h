// Points in the plane.
#pragma once

#include <cmath>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

inline double distance(Point2 p, Point2 q) { return std::hypot(p.x - q.x, p.y - q.y); }

/// Between the directions from `apex` to p and to q: 0 to pi.
inline double angle_between(Point2 apex, Point2 p, Point2 q) {
  const double ux = p.x - apex.x, uy = p.y - apex.y, vx = q.x - apex.x, vy = q.y - apex.y;
  return std::abs(std::atan2(ux * vy - uy * vx, ux * vx + uy * vy));
}

}  // namespace tetropolis
