// Footprints in which the points measure ground: nothing stands there.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Of the buildings, those in which ground is measured, ascending: at least three points inside are
/// ground (class 2 or 9, or at most 0.5 m above the terrain), they are in at least six of ten cells
/// that hold any point but noise, and there are ten times as many of them as roof points. Cells are
/// 2 m wide, in large footprints a tenth of their root area. `roof`: the points extracted for
/// their roofs. The same for any number of threads.
std::vector<std::size_t> find_measured_ground(std::span<const Building> buildings,
                                              const PointLists& roof, const PointCloud& cloud,
                                              const Raster& terrain, const Progress& progress);

}  // namespace tetropolis
