// Area of the symmetric difference of two nearly equal regions, from what differs between their
// outlines.
#pragma once

#include <span>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Area of what is in exactly one of the regions `before` and `after`, in square steps; each is a
/// list of valid polygons with disjoint interiors, in steps. Edges that both share cancel; the rest
/// fall into connected pieces, each of which bounds, by the even-odd rule, a part of the
/// difference. (A piece that lies inside what another one bounds is added rather than subtracted.)
/// The time is near-linear in the number of edges where the regions differ in many small places.
double changed_area(std::span<const Polygon> before, std::span<const Polygon> after);

}  // namespace tetropolis
