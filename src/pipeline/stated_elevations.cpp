#include "stated_elevations.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

namespace tetropolis {

namespace {

struct Weighted {
  double value;
  double weight;
};

double weighted_median(std::vector<Weighted> values) {
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double half = 0;
  for (const Weighted& one : values) half += one.weight / 2;
  for (const Weighted& one : values)
    if (half -= one.weight; half <= 0) return one.value;
  return values.back().value;
}

}  // namespace

void match_to_terrain(const Raster& terrain, const Domain& domain, FootprintsInput& footprints,
                      std::vector<Warning>& warnings) {
  std::vector<Weighted> above, heights;
  for (const Footprint& feature : footprints.features) {
    if (!std::isfinite(feature.base) || feature.polygon.outer.empty()) continue;
    const Point2 p = feature.polygon.outer.front();
    if (!domain.contains(p)) continue;
    const double volume = area(feature.polygon) * feature.height;
    above.push_back({feature.base - sample(terrain, p), volume});
    heights.push_back({feature.height, volume});
  }
  if (above.empty()) return;
  const auto count = static_cast<std::int64_t>(above.size());
  const double off = weighted_median(std::move(above)), typical = weighted_median(heights);
  if (std::abs(off) <= typical) return;
  for (Footprint& feature : footprints.features)
    feature.base = std::numeric_limits<double>::quiet_NaN();
  warnings.push_back(
      {"model_off_terrain", count,
       fmt::format(
           "{}: {} buildings stand {:.1f} m {} the terrain (median), and are moved onto it: "
           "their heights count, and their elevations do not; are these of another "
           "vertical system?",
           footprints.source, count, std::abs(off), off > 0 ? "above" : "below")});
}

}  // namespace tetropolis
