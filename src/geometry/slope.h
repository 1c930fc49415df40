// How steep a triangle in space is.
#pragma once

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Squared cosine of the angle between the horizontal and the plane through a, b and c at their
/// elevations; the three are not on one line as seen from above.
inline double squared_cosine_of_slope(Point2 a, double za, Point2 b, double zb, Point2 c,
                                      double zc) {
  const double bx = b.x - a.x, by = b.y - a.y, bz = zb - za;
  const double cx = c.x - a.x, cy = c.y - a.y, cz = zc - za;
  const double nx = by * cz - bz * cy, ny = bz * cx - bx * cz, nz = bx * cy - by * cx;
  return nz * nz / (nx * nx + ny * ny + nz * nz);
}

}  // namespace tetropolis
