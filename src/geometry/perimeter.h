// The length of outlines. Private to the library.
#pragma once

#include <cmath>

#include "tetropolis/geometry/polygon.h"

#include "geometry/vec2.h"

namespace tetropolis {

/// Of all rings together.
inline double perimeter(const Polygon& polygon) {
  double sum = 0;
  for_each_edge(polygon, [&](Point2 a, Point2 b) { sum += distance(a, b); });
  return sum;
}

}  // namespace tetropolis
