// The domain of a run that is given none, and which buildings it keeps.
#pragma once

#include "tetropolis/geometry/types.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/build_city.h"

namespace tetropolis {

/// Whether at least half of a clean polygon's area lies in `box`.
bool is_mostly_within(const Polygon& polygon, const Bounds2& box);

/// The box of the footprints within that of the points, grown by options.domain_margin as far as
/// there are points. Unless buildings at the boundary are clipped, it then grows beyond the points
/// to keep whole the footprints that lie mostly within their box and reach at most
/// options.domain_margin beyond it: to 10 m around each of them, or options.domain_margin if that
/// is less. Boxes in the local frame; `footprints` are in CRS coordinates, which are those plus
/// `origin`.
Bounds2 default_domain(const BuildCityOptions& options, const FootprintsInput& footprints,
                       const Bounds2& points, Point2 origin);

}  // namespace tetropolis
