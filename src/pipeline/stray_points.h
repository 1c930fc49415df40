// Points far from the city, which would make its domain as large as a country.
#pragma once

#include <cstddef>
#include <vector>

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct StrayPoints {
  std::vector<std::size_t> points;  ///< Ascending.
  Bounds2 rest;                     ///< Extent of all others.
};

/// The points that lie apart from all others in x or y: on the far side of a gap of at
/// least 100 m and a tenth of the whole extent, on each side no more than one in a hundred of all
/// points and ten (again for what is left; in all at most a hundred and one in twenty, else none).
/// `extent` is that of the points.
StrayPoints find_stray_points(const PointCloud& cloud, const Bounds2& extent);

}  // namespace tetropolis
