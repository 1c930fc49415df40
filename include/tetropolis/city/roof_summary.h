// What planes and parts of roofs say in the terms of files.
#pragma once

#include <optional>
#include <span>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Angle to the horizontal, degrees, to a hundredth: that far, all math libraries agree.
double slope_degrees(const RoofPlane& plane);

/// Where the roof looks: downhill, degrees clockwise from north, to a hundredth, in [0, 360); none
/// of a level roof.
std::optional<double> azimuth_degrees(const RoofPlane& plane);

/// The highest level of any part; kBlock without parts.
Lod highest_lod(std::span<const RoofPart> parts);

/// Root mean square over the roof points of all parts that have some, metres; NaN without any.
double rmse_of(std::span<const RoofPart> parts);

/// Of the body between h_ground and the roofs of the parts, or h_roof without parts. Cubic metres.
double volume_of(const Building& building);

/// The lowest and the highest corner of a part's roof.
struct RoofRange {
  double low = 0, high = 0;  ///< Elevations, metres.
};
RoofRange range_of(const RoofPart& part);

/// Elevation of the highest point of its roofs, metres: of the parts, or h_roof without parts.
double highest_roof(const Building& building);

}  // namespace tetropolis
