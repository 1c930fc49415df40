// What can be the elevation of terrain, in metres. Private to src/pipeline.
#pragma once

#include <algorithm>
#include <vector>

namespace tetropolis {

/// Between these all land lies, and the floor of shallow seas. What marks missing values in rasters
/// that do not say so (-9999, 9999, -32768, 1e38) does not.
constexpr double kLowestTerrain = -1000, kHighestTerrain = 9000;

inline bool is_elevation(double z) { return z >= kLowestTerrain && z <= kHighestTerrain; }

/// The first value that is no elevation, or the end.
inline std::vector<double>::const_iterator find_no_elevation(const std::vector<double>& values) {
  return std::find_if_not(values.begin(), values.end(), is_elevation);
}

}  // namespace tetropolis
