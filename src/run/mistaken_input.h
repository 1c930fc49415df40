// Mistakes that can be told before anything is read.
#pragma once

#include <string>

#include "tetropolis/geometry/types.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// Throws Error(kUsage) for a point cloud given as footprints, a vector file given as points, a
/// terrain given as a city model or the other way round, saying that they may be swapped, and for
/// the name of a file given as the folder for the results. What cannot be looked at is left to
/// those who read it.
void refuse_mistaken_files(const Config& config);

/// Throws Error(kUsage) if the bounds are longitudes and latitudes of a place in `data`, in the
/// projected system `crs` and in its coordinates; the message has the bounds to give.
void refuse_degree_bounds(const Config& config, const std::string& crs, const Bounds2& data);

}  // namespace tetropolis
