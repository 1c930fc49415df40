// How accurate transformations between reference systems are with the grids at hand.
#pragma once

#include <optional>
#include <string>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A grid for want of which a transformation is less accurate than it could be.
struct MissingGrid {
  std::string name;  ///< Of the file, as PROJ's data have it: "uk_os_OSTN15_NTv2_OSGBtoETRS.tif".
  std::string url;   ///< Where it can be had; may be empty.
  double accuracy;   ///< Of what is done without it, metres; negative if nobody knows.
  double accuracy_with;  ///< With it.
};

/// The grid of the best transformation around `box` (coordinates of `from`), if PROJ lacks it and
/// what it has instead is worse. Nothing where either system is unknown.
std::optional<MissingGrid> find_missing_grid(const std::string& from, const std::string& to,
                                             const Bounds2& box);

}  // namespace tetropolis
