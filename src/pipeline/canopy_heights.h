// How high the vegetation is.
#pragma once

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Per node of `terrain`, the height above it [m] of the highest point of classes 3 to 5 that is
/// nearest to the node; NaN where there is none. Empty without such points. Precondition: as
/// sample().
Raster measure_canopies(const PointCloud& cloud, const Raster& terrain);

}  // namespace tetropolis
