#include "require_terrain.h"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/row_major.h"

#include "elevations.h"
#include "require_room.h"

namespace tetropolis {

void require_raster(const Raster& raster, const std::string& source) {
  if (raster.nx < 1 || raster.ny < 1 || raster.values.size() != row_major(0, raster.ny, raster.nx))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {} values for {} x {} nodes; give one to each, of one node at "
                            "least",
                            source, raster.values.size(), raster.nx, raster.ny));
  if (!(raster.step > 0) || !std::isfinite(raster.step) || !std::isfinite(raster.x0) ||
      !std::isfinite(raster.y0))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: nodes every {} m from ({}, {}); give a step above 0", source,
                            raster.step, raster.x0, raster.y0));
  const auto wrong = find_no_elevation(raster.values);
  if (wrong == raster.values.end()) return;
  const auto node = static_cast<std::size_t>(wrong - raster.values.begin());
  const auto nx = static_cast<std::size_t>(raster.nx);
  throw Error(ErrorKind::kInput, fmt::format("{}: {} is not an elevation (node {}, {}); fill it",
                                             source, *wrong, node % nx, node / nx));
}

void require_terrain_under(const CityModel& city, const Raster& terrain,
                           const std::string& source) {
  const Bounds2 covered = terrain.bounds().grown(terrain.step);
  if (terrain.values.size() == 1 || covered.covers(city.domain.bounds())) return;
  const Bounds2 there = terrain.bounds().moved(city.origin);
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}, does not cover the domain, "
                  "which is {}; give smaller `bounds` or another terrain",
                  source, there.xmin, there.xmax, there.ymin, there.ymax, domain_text(city)));
}

}  // namespace tetropolis
