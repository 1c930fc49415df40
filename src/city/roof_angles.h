// How a roof plane is turned, as files say it.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// A hundredth of a degree is less than slopes of a millionth over ten metres say; math libraries
/// agree to that.
inline double hundredths_of_degree(double radians) {
  return std::nearbyint(radians * (180 * 100 / std::numbers::pi)) / 100;
}

/// Angle to the horizontal, degrees.
inline double slope_degrees(const RoofPlane& plane) {
  return hundredths_of_degree(std::atan(std::hypot(plane.slope_x, plane.slope_y)));
}

/// Where the roof looks: downhill, degrees clockwise from north, below 360; none of a flat roof.
inline std::optional<double> azimuth_degrees(const RoofPlane& plane) {
  if (plane.is_flat()) return std::nullopt;
  const double azimuth = hundredths_of_degree(std::atan2(-plane.slope_x, -plane.slope_y));
  return azimuth < 0 ? azimuth + 360 : azimuth;
}

}  // namespace tetropolis
