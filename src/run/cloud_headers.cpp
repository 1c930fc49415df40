#include "cloud_headers.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/metric_crs.h"

#include "pipeline/require_metres.h"

namespace tetropolis {

namespace {

/// Counts lie; reading will say so. Until then no more points than bytes are believed.
std::int64_t believable_count(const std::filesystem::path& path, const LasInfo& info) {
  std::error_code error;
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (error) return 0;
  return std::min(info.point_count, bytes / (info.compressed ? 1 : info.record_length));
}

Bounds2 scaled(const Bounds2& box, double by) {
  if (box.empty()) return box;
  return {box.xmin * by, box.ymin * by, box.xmax * by, box.ymax * by};
}

}  // namespace

CloudHeaders read_headers(std::span<const std::filesystem::path> paths) {
  CloudHeaders headers;
  const std::vector<LasInfo> infos = inspect_las(paths);
  for (std::size_t f = 0; f < paths.size(); ++f) {
    const std::filesystem::path& path = paths[f];
    const LasInfo& info = infos[f];
    const Bounds2 box{info.min[0], info.min[1], info.max[0], info.max[1]};
    if (info.point_count > 0 && !box.empty()) headers.box.extend(box);
    headers.points.emplace_back(box, believable_count(path, info));
    if (!info.vertical_crs.empty() || info.vertical_unit != 1) {
      if (headers.vertical_unit && !is_metre(info.vertical_unit / *headers.vertical_unit))
        throw Error(
            ErrorKind::kInput,
            fmt::format("{}: heights are in units of {:.10g} m, but in {} they are in units "
                        "of {:.10g} m; convert them to one unit",
                        path.string(), info.vertical_unit, headers.vertical_file,
                        *headers.vertical_unit));
      headers.vertical_unit = info.vertical_unit;
      headers.vertical_file = path.string();
    }
    if (!info.crs.empty() && headers.crs.empty()) {
      headers.crs = info.crs;
      headers.crs_file = path.string();
    }
  }
  return headers;
}

CloudHeaders headers_of(const PointArrays& points) {
  CloudHeaders headers;
  headers.crs = points.crs;
  headers.crs_file = points.source;
  for (const auto& [x, y, z] : points.xyz)
    if (std::isfinite(x) && std::isfinite(y)) headers.box.extend(Point2{x, y});
  headers.points.emplace_back(headers.box, static_cast<std::int64_t>(points.xyz.size()));
  return headers;
}

double expected_points(const CloudHeaders& headers, const Bounds2& box) {
  double points = 0;
  for (const auto& [file, count] : headers.points) {
    const Bounds2 common = file.intersection(box);
    const double whole = file.width() * file.height();
    if (!common.empty() && whole > 0)
      points += static_cast<double>(count) * common.width() * common.height() / whole;
  }
  return points;
}

std::string stated_points_crs(const Config& config, const std::string& first_file, bool in_memory,
                              CloudHeaders& headers, CloudUnits& units,
                              std::vector<Warning>& warnings) {
  const bool is_set = !config.points_crs.empty();
  std::string crs = normalise_crs(is_set ? config.points_crs : headers.crs);
  const std::string& file = headers.crs_file.empty() ? first_file : headers.crs_file;
  if (crs.empty() || is_geographic(crs) || in_metres(crs).empty())
    require_metres(crs, file, "points_crs");
  if (!crs.empty()) units.across = linear_unit_metres(crs);
  const double stated =
      is_set ? vertical_unit_metres(config.points_crs) : headers.vertical_unit.value_or(1);
  if (stated < 0)
    require_heights_in_metres(stated, is_set ? "points_crs" : headers.vertical_file, "points_crs");
  units.up = stated;
  // Clouds in feet that say nothing of their heights have these in feet, too.
  const bool is_guess = is_metre(stated) && !is_metre(units.across) && !in_memory &&
                        (is_set || !headers.vertical_unit);
  if (is_guess) units.up = units.across;
  if (units.are_metres()) return crs;
  const std::string original = crs_name(crs);
  if (!is_metre(units.across)) crs = in_metres(crs);
  warnings.push_back(
      {"points_units", 1,
       fmt::format("{}: coordinates in units of {:.10g} m ({}) and heights in units of {:.10g} m{} "
                   "are converted to metres ({})",
                   file, units.across, original, units.up, is_guess ? ", as is taken," : "",
                   crs_name(crs))});
  headers.box = scaled(headers.box, units.across);
  for (auto& [box, count] : headers.points) box = scaled(box, units.across);
  return crs;
}

ReadPointsOptions in_units(const CloudUnits& units, const ReadPointsOptions& reading) {
  if (units.are_metres()) return reading;
  ReadPointsOptions converted = reading;
  converted.crs.clear();
  if (reading.crop) converted.crop = scaled(*reading.crop, 1 / units.across);
  if (reading.origin)
    converted.origin = Point2{std::floor(reading.origin->x / units.across),
                              std::floor(reading.origin->y / units.across)};
  return converted;
}

void convert_to_metres(const CloudUnits& units, PointsInput& input) {
  if (units.are_metres()) return;
  const Point2 corner{input.origin.x * units.across, input.origin.y * units.across};
  const Point2 origin{std::floor(corner.x), std::floor(corner.y)};
  const Point2 by{corner.x - origin.x, corner.y - origin.y};
  for (PointCoordinate& x : input.points.x) x = PointCoordinate(x * units.across + by.x);
  for (PointCoordinate& y : input.points.y) y = PointCoordinate(y * units.across + by.y);
  for (PointCoordinate& z : input.points.z) z = PointCoordinate(z * units.up);
  input.extent = scaled(input.extent, units.across);
  if (!input.extent.empty()) input.extent = input.extent.moved(by);
  input.origin = origin;
}

}  // namespace tetropolis
