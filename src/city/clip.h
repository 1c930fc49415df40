// Footprints at the edge of the domain.
#pragma once

#include <vector>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// All parts of a valid polygon within `domain`; none if nothing is left, or GEOS gives up.
std::vector<Polygon> parts_in_domain(const Polygon& polygon, const Domain& domain);

/// Parts of a clean polygon, in metres in the local frame: the largest first, clean
/// (clean_footprint) and on the grid of kCoordinateStep. Slivers below `least_area` square metres
/// are left out beside larger parts, crumbs below that and a square metre always. `lost_area`, if
/// given, becomes their area and that of what cleaning gave up.
std::vector<Polygon> clean_parts(std::vector<Polygon> parts, double least_area,
                                 double* lost_area = nullptr);

/// What clean_parts makes of the parts of a clean polygon within `domain`; up to half a step beyond
/// a `domain` that is not on the grid.
std::vector<Polygon> clip_to_domain(const Polygon& polygon, const Domain& domain, double least_area,
                                    double* lost_area = nullptr);

}  // namespace tetropolis
