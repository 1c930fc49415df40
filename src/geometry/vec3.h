// Vectors in space, for the loops over cells and faces.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

inline Point3 minus(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Point3& v) { return std::sqrt(dot(v, v)); }
inline Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Mean of a tet's corners.
inline Point3 centre_of(const std::array<Point3, 4>& p) {
  Point3 centre{};
  for (std::size_t c = 0; c < 3; ++c) centre[c] = (p[0][c] + p[1][c] + p[2][c] + p[3][c]) / 4;
  return centre;
}

}  // namespace tetropolis
