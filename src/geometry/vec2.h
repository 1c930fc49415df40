// Points in the plane.
#pragma once

#include <cmath>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

inline double distance(Point2 p, Point2 q) { return std::hypot(p.x - q.x, p.y - q.y); }

}  // namespace tetropolis
