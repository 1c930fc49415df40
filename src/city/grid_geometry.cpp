#include "grid_geometry.h"

#include <algorithm>
#include <cstddef>

namespace tetropolis::grid {

namespace {

template <typename Convert>
Polygon converted(const Polygon& polygon, const Convert& convert) {
  Polygon result = polygon;
  for_each_vertex(result, [&](Point2& p) { p = convert(p); });
  return result;
}

}  // namespace

Polygon to_steps(const Polygon& polygon) {
  return converted(polygon, [](Point2 p) { return to_steps(p); });
}

Polygon to_metres(const Polygon& polygon) {
  return converted(polygon, [](Point2 p) { return to_metres(p); });
}

}  // namespace tetropolis::grid
