// Points far from the city, which would make its domain as large as a country.
#pragma once

#include <cstddef>
#include <vector>

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The points, ascending, that lie apart from all others in x or y: on the far side of a gap of at
/// least 100 m and a tenth of the whole extent, no more than ten of them there, or one in 100,000
/// (again for what is left). `extent` is that of the points.
std::vector<std::size_t> find_stray_points(const PointCloud& cloud, const Bounds2& extent);

}  // namespace tetropolis
