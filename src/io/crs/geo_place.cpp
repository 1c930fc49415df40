#include "tetropolis/io/crs/geo_place.h"

#include <cmath>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

#include "gdal_support.h"

namespace tetropolis {

namespace {

/// "Netherlands" of "Netherlands - onshore, including Waddenzee, ...", "Liechtenstein; Switzerland"
/// of "Liechtenstein; Switzerland."; empty where the description begins with no name.
std::string area_name(std::string_view description) {
  for (const std::string_view begin : {"Between", "World", "Not specified"})
    if (description.starts_with(begin)) return "";
  for (const std::string_view end :
       {" - ", " onshore", " between ", " west of ", " east of ", ": ", "."})
    description = description.substr(0, description.find(end));
  return std::string(description);
}

}  // namespace

std::optional<GeoPlace> place_of(const std::string& crs, Point2 at) try {
  if (crs.empty()) return std::nullopt;
  const Point2 degrees = reproject(std::span(&at, 1), crs, "EPSG:4326").front();
  if (std::isnan(degrees.x)) return std::nullopt;
  GeoPlace place{degrees.x, degrees.y, "", true};
  const gdal::QuietErrors errors;
  const gdal::Srs srs = gdal::parse_srs(crs);
  Bounds2 area;
  const char* name = nullptr;
  if (srs == nullptr ||
      OSRGetAreaOfUse(srs.get(), &area.xmin, &area.ymin, &area.xmax, &area.ymax, &name) == 0 ||
      name == nullptr)
    return place;
  place.area = area_name(name);
  // Areas across the meridian of 180 degrees begin in the east.
  if (area.xmin <= area.xmax) place.is_in_area = area.grown(1).contains(degrees);
  return place;
} catch (const Error&) {  // a system of its own, without a way to WGS 84
  return std::nullopt;
}

std::optional<GeoPlace> place_of(const std::string& crs, const Bounds2& box) {
  return place_of(crs, Point2{(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2});
}

std::string position_text(const GeoPlace& place) {
  return fmt::format("{:.4f} {}, {:.4f} {}", std::abs(place.latitude),
                     place.latitude < 0 ? 'S' : 'N', std::abs(place.longitude),
                     place.longitude < 0 ? 'W' : 'E');
}

std::string place_text(const GeoPlace& place) {
  return position_text(place) + (place.area.empty() ? "" : " (" + place.area + ")");
}

}  // namespace tetropolis
