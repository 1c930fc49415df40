// Stated roofs as points, from which roofs are made. Private to src/city.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/city/stated_roof.h"

namespace tetropolis {

/// The highest of the roofs at the points of a grid of half a metre, (i / 2 + 1/4, j / 2 + 1/4)
/// with whole i and j, that lie in `footprint` and under a roof; elevations, with `base` that of
/// height 0. Local frame, metres.
std::vector<Point3> sample_roofs(std::span<const StatedRoof> roofs, const Polygon& footprint,
                                 double base);

}  // namespace tetropolis
