// Roofs that the input states, as city models do.
#pragma once

#include <array>
#include <limits>
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
  std::array<double, 3> height;  ///< Above the base of its building there, metres.
};

/// The roofs of one footprint.
struct StatedBody {
  std::span<const StatedRoof> roofs;
  /// Elevation that their heights are above, metres; NaN: that of the footprint's ground.
  double base = std::numeric_limits<double>::quiet_NaN();
};

/// By source id of the footprint.
using StatedRoofs = std::map<std::string_view, StatedBody>;

/// Of a footprint, or of the one that it was cut from ("ID#2"); null if that has none.
inline const StatedBody* find_body(const StatedRoofs& stated, std::string_view source_id) {
  auto found = stated.find(source_id);
  if (found == stated.end()) found = stated.find(source_id.substr(0, source_id.rfind('#')));
  return found == stated.end() ? nullptr : &found->second;
}

}  // namespace tetropolis
