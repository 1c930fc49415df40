#include "tetropolis/city/heights.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::uint32_t kHeightFlags =
    kGroundFromDtm | kRoofFromUnclassified | kRoofFromAttribute | kNoRoofPoints | kMinimumHeight;

/// The heights of the listed points, in `heights`.
std::span<double> gather(std::span<const PointIndex> list, const PointCloud& cloud,
                         std::vector<double>& heights) {
  heights.clear();
  for (const PointIndex p : list) heights.push_back(cloud.z[p]);
  return heights;
}

void set_ground(Building& building, std::span<double> heights, const Raster& dtm,
                const HeightOptions& options) {
  building.n_ground_points = static_cast<std::int64_t>(heights.size());
  if (heights.empty()) {
    building.h_ground = snap_height(sample(dtm, interior_point(building.footprint)));
    building.flags |= kGroundFromDtm;
  } else {
    building.h_ground = snap_height(percentile(heights, options.ground_percentile));
  }
}

/// Precondition: h_ground is set.
void set_roof(Building& building, std::span<double> heights, bool unclassified,
              const HeightOptions& options) {
  building.n_roof_points = static_cast<std::int64_t>(heights.size());
  const double lowest = building.h_ground + options.min_height;
  if (std::isfinite(building.attribute_roof)) {
    constexpr double kLeast = 0.001;  // metres: what is below ground has a height, too
    building.attribute_height =
        snap_height(std::max(building.attribute_roof - building.h_ground, kLeast));
  }
  if (!heights.empty()) {
    building.h_roof = percentile(heights, options.roof_percentile);
    if (unclassified) building.flags |= kRoofFromUnclassified;
  } else if (std::isfinite(building.attribute_height) && building.attribute_height > 0) {
    building.h_roof = building.h_ground + building.attribute_height;
    building.flags |= kRoofFromAttribute;
  } else {
    building.h_roof = lowest;
    building.flags |= kNoRoofPoints;
  }
  if (building.h_roof < lowest) {
    building.h_roof = lowest;
    building.flags |= kMinimumHeight;
  }
  building.h_roof = snap_height(building.h_roof);
}

}  // namespace

double percentile(std::span<double> values, double p) {
  assert(!values.empty() && p >= 0 && p <= 100);
  const double position = static_cast<double>(values.size() - 1) * (p / 100);
  const auto lower = std::min(static_cast<std::size_t>(position), values.size() - 1);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(lower);
  std::nth_element(values.begin(), nth, values.end());
  if (lower + 1 == values.size()) return *nth;
  const double below = *nth;
  const double above = *std::min_element(nth + 1, values.end());
  // From the nearer end, so that the result never leaves [below, above].
  const double share = position - static_cast<double>(lower);
  return share < 0.5 ? below + (above - below) * share : above - (above - below) * (1 - share);
}

void compute_heights(std::span<Building> buildings, const BuildingPoints& points,
                     const PointCloud& cloud, const Raster& dtm, const HeightOptions& options) {
  assert(points.roof.size() == buildings.size() && points.ground.size() == buildings.size() &&
         points.by_exclusion.size() == buildings.size());
  parallel_chunks(buildings.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> heights;
    for (std::size_t b = begin; b < end; ++b) {
      Building& building = buildings[b];
      building.flags &= ~kHeightFlags;
      set_ground(building, gather(points.ground[b], cloud, heights), dtm, options);
      set_roof(building, gather(points.roof[b], cloud, heights), points.by_exclusion[b] != 0,
               options);
    }
  });
}

}  // namespace tetropolis
