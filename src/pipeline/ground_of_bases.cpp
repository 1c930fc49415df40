#include "ground_of_bases.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/dtm.h"

#include "city/footprint_index.h"
#include "core/infinity.h"
#include "terrain/fill_smoothly.h"

namespace tetropolis {

namespace {

/// Whether `small` is part of the walls or the roof of `large`, if they touch: a dormer, a balcony.
bool is_attached(const Footprint& small, const Footprint& large) {
  constexpr double kStorey = 3;  // metres
  return small.base > large.base + kStorey && small.base <= large.base + large.height &&
         area(small.polygon) < area(large.polygon) / 2;
}

/// Whose base is the ground at each node of `raster`, as a position in `standing`.
std::vector<BuildingIndex> owners_of(const std::vector<const Footprint*>& standing, Point2 origin,
                                     const Raster& raster) {
  std::vector<const Polygon*> outlines;
  for (const Footprint* feature : standing) outlines.push_back(&feature->polygon);
  constexpr double kBeside = 1;  // metres
  const FootprintIndex index(outlines, kBeside);
  std::vector<BuildingIndex> owners(raster.values.size(), BuildingIndex::none()), inside, near;
  std::vector<std::int64_t> covered(standing.size()), owned(standing.size());
  const auto is_lower = [&](BuildingIndex f, BuildingIndex g) {
    return standing[f]->base < standing[g]->base;
  };
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i) {
      inside.clear(), near.clear();
      index.at({origin.x + raster.x0 + i * raster.step, origin.y + raster.y0 + j * raster.step},
               [&](BuildingIndex f, bool is_inside) {
                 near.push_back(f);
                 if (is_inside) inside.push_back(f);
               });
      if (inside.empty()) continue;
      for (const BuildingIndex f : inside) ++covered[f];
      const BuildingIndex lowest = *std::min_element(inside.begin(), inside.end(), is_lower);
      owners[row_major(i, j, raster.nx)] = lowest;
      if (std::none_of(near.begin(), near.end(), [&](BuildingIndex f) {
            return is_attached(*standing[lowest], *standing[f]);
          }))
        ++owned[lowest];
    }
  for (BuildingIndex& owner : owners)
    if (owner.valid() && 2 * owned[owner] <= covered[owner]) owner = BuildingIndex::none();
  return owners;
}

}  // namespace

std::optional<TerrainInput> ground_of_bases(const FootprintsInput& footprints, const Bounds2& box,
                                            Point2 origin, double step,
                                            std::vector<Warning>& warnings) {
  std::vector<const Footprint*> standing;
  for (const Footprint& feature : footprints.features)
    if (std::isfinite(feature.base)) standing.push_back(&feature);
  if (standing.empty() || box.empty()) return {};
  TerrainInput terrain;
  terrain.source = "the bases of buildings";
  terrain.origin = origin;
  terrain.crs = footprints.crs;
  terrain.is_of_bases = true;
  Raster& raster = terrain.raster = dtm_grid(box.moved({-origin.x, -origin.y}), step);
  const std::vector<BuildingIndex> owners = owners_of(standing, origin, raster);
  std::vector<bool> counts(standing.size(), false);
  double low = kInfinity, high = -kInfinity;
  for (std::size_t node = 0; node < owners.size(); ++node) {
    double& z = raster.values[node];
    z = std::numeric_limits<double>::quiet_NaN();
    const BuildingIndex owner = owners[node];
    if (!owner.valid()) continue;
    z = standing[owner]->base;
    counts[owner] = true;
    low = std::min(low, z);
    high = std::max(high, z);
  }
  const auto count = std::count(counts.begin(), counts.end(), true);
  if (count == 0) return {};
  fill_smoothly(raster);
  warnings.push_back(
      {"ground_of_bases", count,
       fmt::format("no terrain is given: the ground is at the bases of {} buildings of the model, "
                   "{:.1f} to {:.1f} m, and interpolated between them; give a raster with `dtm`",
                   count, low, high)});
  return terrain;
}

}  // namespace tetropolis
