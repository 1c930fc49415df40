// What footprints ask of a domain.
#pragma once

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Throws Error(kInput) unless footprints have room between the domain's sides. For the message:
/// `source`, what the domain comes from, and `in_it`, what is there.
inline void require_room(double min_distance, const Bounds2& domain, const std::string& source,
                         const std::string& in_it = "") {
  const double least = 2 * min_distance;
  if (domain.width() >= least && domain.height() >= least) return;
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: the domain is {:.3f} m x {:.3f} m{}, too small for footprints {} m apart; "
                  "give more data, larger `bounds` or lower min_building_distance",
                  source, std::max(domain.width(), 0.0), std::max(domain.height(), 0.0), in_it,
                  min_distance));
}

/// Where a city's domain is, in its reference system, for messages.
inline std::string domain_text(const CityModel& city) {
  const Bounds2 domain = city.domain.moved(city.origin).bounds();
  return fmt::format("x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}", domain.xmin, domain.xmax,
                     domain.ymin, domain.ymax);
}

}  // namespace tetropolis
