#include "read_canopies.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/heights.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "file_and_attribute.h"
#include "read_areas.h"

namespace tetropolis {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The highest tree there is has 116 m.
constexpr double kHighest = 120;

/// Of the points in a canopy, how many per cent are below its top.
constexpr double kTopPercentile = 90;

const AttributeColumn* column_of(const FootprintsInput& input, const std::string& name) {
  for (const AttributeColumn& column : input.attributes)
    if (column.name == name) return &column;
  return nullptr;
}

/// The number that a feature has in a column, or in none; NaN if that is none.
double number_of(const AttributeColumn* column, std::int64_t feature) {
  const auto row = static_cast<std::size_t>(feature);
  if (column == nullptr || feature < 0 || (!column->known.empty() && !column->known[row]))
    return kNone;
  if (const auto* numbers = std::get_if<std::vector<double>>(&column->values))
    return (*numbers)[row];
  if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&column->values))
    return static_cast<double>((*integers)[row]);
  const std::string& text = std::get<std::vector<std::string>>(column->values)[row];
  double value = kNone;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ptr == text.data() + text.size() ? value : kNone;
}

/// NaN without vegetation in the polygon, which is `origin` away from the raster's frame.
double measured_height(const Raster& measured, const Polygon& area, Point2 origin) {
  const Bounds2 box = bounds(area).moved({-origin.x, -origin.y});
  const auto node = [&](double at, double zero, std::int32_t count, bool up) {
    const double i = (at - zero) / measured.step;
    return static_cast<std::int32_t>(
        std::clamp(up ? std::ceil(i) : std::floor(i), 0.0, static_cast<double>(count)));
  };
  std::vector<double> heights;
  const std::int32_t end_x = node(box.xmax, measured.x0 - measured.step, measured.nx, false);
  const std::int32_t end_y = node(box.ymax, measured.y0 - measured.step, measured.ny, false);
  for (std::int32_t j = node(box.ymin, measured.y0, measured.ny, true); j < end_y; ++j)
    for (std::int32_t i = node(box.xmin, measured.x0, measured.nx, true); i < end_x; ++i)
      if (std::isfinite(measured.at(i, j)) &&
          contains(area, {origin.x + measured.x0 + i * measured.step,
                          origin.y + measured.y0 + j * measured.step}))
        heights.push_back(measured.at(i, j));
  return heights.empty() ? kNone : percentile(heights, kTopPercentile);
}

/// Why it is no canopy, or nothing.
std::string fault_of(const Canopy& canopy, bool is_measured) {
  if (std::isnan(canopy.height))
    return is_measured ? "no point of classes 3 to 5 in it" : "no height";
  if (!(canopy.height > 0 && canopy.height <= kHighest))
    return fmt::format("its height is {:g} m", canopy.height);
  if (!(canopy.base >= 0 && canopy.base < canopy.height))
    return fmt::format("its crown_base is {:g} m, its height {:g} m", canopy.base, canopy.height);
  if (!(canopy.leaf_area_density > 0) || !std::isfinite(canopy.leaf_area_density))
    return fmt::format("its leaf_area_density is {:g}", canopy.leaf_area_density);
  return {};
}

}  // namespace

std::vector<Canopy> read_canopies(const Config& config, const CityModel& city,
                                  const Raster& measured, std::vector<Warning>& warnings) {
  std::vector<Canopy> canopies;
  const Bounds2 domain = city.domain.bounds().moved(city.origin);
  for (const std::string& text : config.canopies) {
    const FileAndAttribute entry = parse_file_and_attribute("canopies", text);
    const bool is_measured = entry.attribute.empty();
    if (is_measured && measured.values.empty())
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: heights of canopies are measured by points of classes 3 to 5 of "
                              "`build`, and there are none; name an attribute with heights "
                              "(canopies FILE:ATTRIBUTE)",
                              entry.file));
    FootprintsInput input = read_areas(entry.file, city.crs, domain, true, warnings);
    if (input.features.empty())
      throw Error(ErrorKind::kInput, entry.file + ": has no polygon; leave it out of canopies");
    const AttributeColumn* heights = column_of(input, entry.attribute);
    if (!is_measured && heights == nullptr)
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: has no attribute {}; canopies takes FILE:ATTRIBUTE with heights "
                              "in metres, or FILE",
                              entry.file, entry.attribute));
    const AttributeColumn* density = column_of(input, "leaf_area_density");
    const AttributeColumn* base = column_of(input, "crown_base");
    std::int64_t left_out = 0;
    std::string first;
    for (Footprint& feature : input.features) {
      if (!bounds(feature.polygon).intersects(domain)) continue;
      const auto or_else = [](double value, double other) {
        return std::isnan(value) ? other : value;
      };
      Canopy canopy;
      canopy.height = is_measured ? measured_height(measured, feature.polygon, city.origin)
                                  : number_of(heights, feature.feature);
      canopy.base = or_else(number_of(base, feature.feature), 0);
      canopy.leaf_area_density =
          or_else(number_of(density, feature.feature), config.leaf_area_density);
      canopy.area = std::move(feature.polygon);
      const std::string fault = fault_of(canopy, is_measured);
      if (fault.empty())
        canopies.push_back(std::move(canopy));
      else if (++left_out == 1)
        first = fmt::format("{}: {}", feature.source_id, fault);
    }
    if (left_out > 0)
      warnings.push_back({"canopy_left_out", left_out,
                          fmt::format("{} canopies of {} are left out, the first, {}", left_out,
                                      entry.file, first)});
    if (!input.dropped.empty())
      warnings.push_back(
          {"canopy_unusable", static_cast<std::int64_t>(input.dropped.size()),
           fmt::format("{} features of {} are no polygons, the first, {}: {}", input.dropped.size(),
                       entry.file, input.dropped.front().source_id, input.dropped.front().reason)});
  }
  return canopies;
}

}  // namespace tetropolis
