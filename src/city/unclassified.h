// Which buildings of a classified cloud the classes say nothing of. Private to src/city.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/city/extract.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/polygon.h"

namespace tetropolis {

/// Of the same length.
struct Unclassified {
  std::vector<BuildingIndex> buildings;  ///< Ascending.
  std::vector<std::uint8_t> in_ranges;   ///< 1: most of its points are in the ranges.
};

/// The buildings that have more points of `ranges` inside than in `roof`, and those whose list in
/// `roof` is empty like those of the buildings around: at least three more are empty than not, its
/// own counted. (Where others have points of their class, a building without any was not there.)
/// Around: with the centre of the bounding box in the same square of 100 m or one beside it.
Unclassified find_unclassified(std::span<const Polygon* const> footprints, const PointLists& roof,
                               const PointCloud& cloud, std::span<const PointRange> ranges,
                               const Progress& progress);

}  // namespace tetropolis
