// Ground that rises from a line no more steeply than it may. Private to src/volume.
#pragma once

#include <algorithm>
#include <cmath>

#include "tetropolis/geometry/types.h"

#include "core/infinity.h"
#include "geometry/vec2.h"

namespace tetropolis {

/// Highest that p may be above the line from a to b, at elevations za and zb at its ends, if
/// nothing rises from it more steeply than `slope`: the least of elevation + slope * distance along
/// it. An end at infinity is not there. This is the update of a triangle in fast marching (Kimmel
/// and Sethian, "Computing geodesic paths on manifolds", PNAS 95, 1998).
inline double highest_at(Point2 p, Point2 a, double za, Point2 b, double zb, double slope) {
  const double at_ends = std::min(za + slope * distance(p, a), zb + slope * distance(p, b));
  if (za == kInfinity || zb == kInfinity) return at_ends;
  const double ex = b.x - a.x, ey = b.y - a.y, length = std::hypot(ex, ey);
  const double rise = (zb - za) / length;
  if (!(std::abs(rise) < slope)) return at_ends;
  const double foot = ((p.x - a.x) * ex + (p.y - a.y) * ey) / length;
  const double away = std::abs((p.x - a.x) * ey - (p.y - a.y) * ex) / length;
  const double least = foot - away * rise / std::sqrt(slope * slope - rise * rise);
  if (!(least > 0 && least < length)) return at_ends;
  return std::min(at_ends, za + rise * least + slope * std::hypot(least - foot, away));
}

}  // namespace tetropolis
