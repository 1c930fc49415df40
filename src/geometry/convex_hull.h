// Private to src.
#pragma once

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Convex hull, counter-clockwise, without collinear vertices; exact. Fewer than three points where
/// the input is on one line. Andrew's monotone chain (Information Processing Letters 9, 1979).
Ring convex_hull(Ring points);

}  // namespace tetropolis
