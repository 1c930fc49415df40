// What `build`, `city` and `mesh` ask of a domain. Private to src/pipeline.
#pragma once

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// Throws Error(kInput) unless footprints have room between the domain's sides. For the message:
/// `source`, what the domain comes from, and `in_it`, what is there.
inline void require_room(const Config& config, const Bounds2& domain, const std::string& source,
                         const std::string& in_it = "") {
  const double least = 2 * config.min_building_distance;
  if (domain.width() >= least && domain.height() >= least) return;
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: the domain is {:.3f} m x {:.3f} m{}, too small for footprints {} m apart; "
                  "give more data, larger --bounds or lower --min-building-distance",
                  source, std::max(domain.width(), 0.0), std::max(domain.height(), 0.0), in_it,
                  config.min_building_distance));
}

}  // namespace tetropolis
