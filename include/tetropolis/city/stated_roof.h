// Roofs that the input states, as city models do.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string_view>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// What a footprint has below one plane. Any coordinates in metres; the plane is given by three of
/// its points, so that both are moved and reprojected alike.
struct StatedRoof {
  Polygon outline;
  std::array<Point2, 3> at;      ///< Not on one line.
  std::array<double, 3> height;  ///< Above the ground of its building there, metres.
};

/// By source id of the footprint.
using StatedRoofs = std::map<std::string_view, std::span<const StatedRoof>>;

}  // namespace tetropolis
