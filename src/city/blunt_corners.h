// Sharp corners of footprints, cut where they are narrow.
#pragma once

#include <cstdint>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Cuts every corner sharper than 15 degrees, of the inside or of the outside, where its two sides
/// are `distance` apart (steps, grid_geometry.h): cells in a corner have its angle as a dihedral
/// angle. Left as it is: a corner of which less than `distance` of a side would remain, or whose
/// cut would come closer than that to the edge behind it. If all features of the polygon and
/// whatever is around it are `distance` apart before, they are after, but for rounding of a step.
/// Returns how many were cut.
std::int64_t blunt_corners(Polygon& polygon, double distance);

}  // namespace tetropolis
