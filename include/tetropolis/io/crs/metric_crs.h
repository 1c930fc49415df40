// Systems in metres for data that are in feet or degrees.
#pragma once

#include <string>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The same projection with its coordinates in metres: the system itself, or one that differs from
/// it by nothing but the unit (of EPSG:2263, in US survey feet, EPSG:32118); "" for local systems.
/// Precondition: not in degrees.
std::string in_metres(const std::string& crs);

/// Whether lengths in a system are lengths on the ground in the middle of `box`, to within 1 %;
/// true where that is unknown. Not so in web Mercator.
bool is_true_to_scale(const std::string& crs, const Bounds2& box);

/// The zone of UTM on WGS 84 around a place in degrees: "EPSG:32632".
std::string utm_zone(Point2 longitude_latitude);

}  // namespace tetropolis
