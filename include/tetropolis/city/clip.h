// Footprints at the edge of the domain.
#pragma once

#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

enum class DomainPosition {
  kInside,    ///< The footprint's box lies within the domain.
  kCrossing,  ///< It lies partly within it.
  kOutside,   ///< It does not meet it.
};

/// Decided by the box of the polygon's finite vertices; a polygon without any counts as inside.
DomainPosition position_in_domain(const Polygon& polygon, const Bounds2& domain);

/// All parts of a valid polygon within `box`; none if nothing is left, or GEOS gives up.
std::vector<Polygon> parts_in_box(const Polygon& polygon, const Bounds2& box);

/// Both in metres in the local frame. The largest part of a clean polygon within `box`, clean
/// (clean_footprint) and on the grid of kCoordinateStep, so up to half a step beyond a `box` that
/// is not; empty if nothing is left.
Polygon clip_to_box(const Polygon& polygon, const Bounds2& box);

}  // namespace tetropolis
