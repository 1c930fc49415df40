// The reference system that points and footprints have in common.
#pragma once

#include <string>

#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// The reference system of a cloud in `points_crs` (empty: it does not say) and of the footprints.
/// Throws Error(kInput): footprints in degrees or in units other than metres, with a cloud that
/// says nothing; or a cloud in another system than they are.
std::string common_crs(const std::string& points_crs, const FootprintsInput& footprints);

/// The same of points that have been read, with refuse_unmarked_degrees.
std::string common_crs(const PointsInput& points, const FootprintsInput& footprints);

/// Without any statement about the system, coordinates that all fit on the globe and span less than
/// a few degrees are taken for what they almost certainly are. Throws Error(kInput) naming `source`
/// and the setting that states their system.
void refuse_unmarked_degrees(const Bounds2& box, const std::string& source, const char* setting);

}  // namespace tetropolis
