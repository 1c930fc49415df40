// Where on Earth something is.
#pragma once

#include <optional>
#include <string>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct GeoPlace {
  double longitude = 0;  ///< WGS 84, degrees.
  double latitude = 0;
  std::string area;        ///< What the system is made for: "Netherlands", "Europe"; may be "".
  bool is_in_area = true;  ///< Or less than a degree outside of it, as far as PROJ knows.
};

/// The place of a position in the system `crs` (crs.h), by PROJ's database. Nothing for the unknown
/// system, or where the position cannot be transformed.
std::optional<GeoPlace> place_of(const std::string& crs, Point2 at);

/// Of the middle of a box.
std::optional<GeoPlace> place_of(const std::string& crs, const Bounds2& box);

/// "52.0083 N, 4.3657 E".
std::string position_text(const GeoPlace& place);

/// "52.0083 N, 4.3657 E (Netherlands)".
std::string place_text(const GeoPlace& place);

}  // namespace tetropolis
