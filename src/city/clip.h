// Footprints at the edge of the domain.
#pragma once

#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

enum class DomainPosition {
  kInside,    ///< The footprint's box lies within the domain.
  kCrossing,  ///< The box lies partly within it; the footprint itself may lie beside it.
  kOutside,   ///< The box does not meet it.
};

/// Decided by the box of the outer ring's vertices. A coordinate that is NaN counts for nothing,
/// one that is infinite as it is; a polygon without numbers for both x and y counts as inside.
DomainPosition position_in_domain(const Polygon& polygon, const Bounds2& domain);

/// All parts of a valid polygon within `box`; none if nothing is left, or GEOS gives up.
std::vector<Polygon> parts_in_box(const Polygon& polygon, const Bounds2& box);

/// Both in metres in the local frame. The parts of a clean polygon within `box`, the largest first,
/// clean (clean_footprint) and on the grid of kCoordinateStep, so up to half a step beyond a `box`
/// that is not; none if nothing is left. Slivers below `least_area` square metres are left out
/// beside larger parts, crumbs below that and a square metre always. `lost_area`, if given, becomes
/// their area and that of what cleaning gave up.
std::vector<Polygon> clip_to_box(const Polygon& polygon, const Bounds2& box, double least_area,
                                 double* lost_area = nullptr);

}  // namespace tetropolis
