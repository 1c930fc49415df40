// Which polygons are closer than a distance (the paper's Algorithm 1). Coordinates are steps
// (grid_geometry.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The number of each polygon's cluster: polygons that overlap or are closer than `distance`,
/// directly or through others. Clusters are numbered by their first polygon. The pairs come from a
/// grid over all edges (in place of Algorithm 1's bins over whole polygons), in near-linear time
/// also where very many polygons lie on each other.
std::vector<std::int32_t> cluster_polygons(std::span<const Polygon> polygons, double distance);

}  // namespace tetropolis
