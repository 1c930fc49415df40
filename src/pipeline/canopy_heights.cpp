#include "canopy_heights.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "tetropolis/core/row_major.h"

namespace tetropolis {

Raster measure_canopies(const PointCloud& cloud, const Raster& terrain) {
  Raster heights;
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    const std::uint8_t code = cloud.classification[p];
    if (code < kLowVegetation || code > kHighVegetation) continue;
    if (heights.values.empty()) {
      heights = terrain;
      heights.values.assign(terrain.values.size(), std::numeric_limits<double>::quiet_NaN());
    }
    const Point2 at{cloud.x[p], cloud.y[p]};
    const double i = std::round((at.x - terrain.x0) / terrain.step);
    const double j = std::round((at.y - terrain.y0) / terrain.step);
    if (!(i >= 0 && i < terrain.nx && j >= 0 && j < terrain.ny)) continue;
    double& highest = heights.values[row_major(static_cast<std::int32_t>(i),
                                               static_cast<std::int32_t>(j), terrain.nx)];
    const double height = cloud.z[p] - sample(terrain, at);
    if (!(highest >= height)) highest = height;
  }
  return heights;
}

}  // namespace tetropolis
