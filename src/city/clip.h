// Footprints at the edge of the domain.
#pragma once

#include <vector>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// All parts of a valid polygon within `domain`; none if nothing is left, or GEOS gives up.
std::vector<Polygon> parts_in_domain(const Polygon& polygon, const Domain& domain);

/// Both in metres in the local frame. The parts of a clean polygon within `domain`, the largest
/// first, clean (clean_footprint) and on the grid of kCoordinateStep, so up to half a step beyond a
/// `domain` that is not; none if nothing is left. Slivers below `least_area` square metres are left
/// out beside larger parts, crumbs below that and a square metre always. `lost_area`, if given,
/// becomes their area and that of what cleaning gave up.
std::vector<Polygon> clip_to_domain(const Polygon& polygon, const Domain& domain, double least_area,
                                    double* lost_area = nullptr);

}  // namespace tetropolis
