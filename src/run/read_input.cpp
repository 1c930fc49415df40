#include "read_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/las/las.h"

#include "footprint_extent.h"
#include "memory.h"
#include "require_metres.h"
#include "require_room.h"
#include "stray_points.h"

namespace tetropolis {

namespace {

double rounded(double metres) {
  constexpr double kDecimetres = 10;
  return std::round(metres * kDecimetres) / kDecimetres;
}

/// To a decimetre, but no more than ten digits: broken headers hold any number.
std::string box_text(const Bounds2& box) {
  return fmt::format("x {:.10g} .. {:.10g}, y {:.10g} .. {:.10g}", rounded(box.xmin),
                     rounded(box.xmax), rounded(box.ymin), rounded(box.ymax));
}

Bounds2 intersection(const Bounds2& a, const Bounds2& b) {
  return {std::max(a.xmin, b.xmin), std::max(a.ymin, b.ymin), std::min(a.xmax, b.xmax),
          std::min(a.ymax, b.ymax)};
}

/// What the headers of all clouds say together.
struct CloudHeaders {
  std::string crs;
  std::string crs_file;
  double vertical_unit = 1;  ///< Of the first file whose heights are not in metres.
  std::string vertical_file;
  Bounds2 box = Bounds2::nothing();
  std::vector<std::pair<Bounds2, std::int64_t>> points;  ///< Per file: where, and how many.
};

/// Counts lie; reading will say so. Until then no more points than bytes are believed.
std::int64_t believable_count(const std::filesystem::path& path, const LasInfo& info) {
  std::error_code error;
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (error) return 0;
  return std::min(info.point_count, bytes / (info.compressed ? 1 : info.record_length));
}

CloudHeaders read_headers(std::span<const std::filesystem::path> paths) {
  CloudHeaders headers;
  const std::vector<LasInfo> infos = inspect_las(paths);
  for (std::size_t f = 0; f < paths.size(); ++f) {
    const std::filesystem::path& path = paths[f];
    const LasInfo& info = infos[f];
    const Bounds2 box{info.min[0], info.min[1], info.max[0], info.max[1]};
    if (info.point_count > 0 && !box.empty()) headers.box.extend(box);
    headers.points.emplace_back(box, believable_count(path, info));
    if (headers.vertical_unit == 1 && info.vertical_unit != 1) {
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

/// Without any statement about the system, coordinates that all fit on the globe and span less than
/// a few degrees are taken for what they almost certainly are.
void refuse_unmarked_degrees(const Bounds2& box, const std::string& file, const char* option) {
  constexpr Bounds2 kGlobe{-180, -90, 180, 90}, kSwapped{-90, -180, 90, 180};
  if (box.empty() || std::max(box.width(), box.height()) > 2) return;
  const bool on_globe = kGlobe.covers(box);
  if (!on_globe && !kSwapped.covers(box)) return;
  throw Error(ErrorKind::kInput,
              fmt::format("{}: coordinates look like degrees ({:.5f}, {:.5f}) - ({:.5f}, {:.5f}){}",
                          file, box.xmin, box.ymin, box.xmax, box.ymax,
                          on_globe ? fmt::format("; name their CRS with {}", option)
                                   : ", latitude first; exchange the two"));
}

/// The points' reference system after the footprints have been read.
std::string common_crs(const Config& config, const std::string& points_crs,
                       const FootprintsInput& footprints) {
  if (!points_crs.empty()) return points_crs;
  if (footprints.crs.empty()) return {};
  // GeoJSON without a word about it is in degrees; without a footprint it says nothing.
  if (is_geographic(footprints.crs) && footprints.features.empty()) return {};
  if (is_geographic(footprints.crs))
    throw Error(
        ErrorKind::kInput,
        fmt::format(
            "{}: footprints are in degrees ({}) and the point cloud has no CRS of its own; name it "
            "with --points-crs (or that of the footprints with --footprints-crs, if they are not)",
            config.footprints, crs_name(footprints.crs)));
  if (const double unit = linear_unit_metres(footprints.crs); !is_metre(unit))
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: footprints are in units of {} m ({}) and the point cloud has no CRS of "
                    "its own; name it with --points-crs",
                    config.footprints, unit, crs_name(footprints.crs)));
  return footprints.crs;
}

FootprintsInput read_all_footprints(const Config& config, const std::string& points_crs,
                                    StepClock& clock) {
  if (config.footprints.empty()) return {};
  ReadFootprintsOptions options;
  options.layer = config.layer;
  options.id_attribute = config.id_attribute;
  options.height_attribute = config.height_attribute;
  options.source_crs = config.footprints_crs;
  options.target_crs = points_crs;
  return clock.run("1.2", "read footprints",
                   [&](const Progress&) { return read_footprints(config.footprints, options); });
}

/// From the box of the footprints; where none is usable it stays, and they are told of later.
void leave_out_unusable(const Config& config, FootprintsInput& footprints) {
  const Bounds2 usable = footprint_extent(footprints.features, config.parallel_tolerance);
  if (!usable.empty()) footprints.bounds = usable;
}

/// The box in which points can matter, CRS coordinates.
Bounds2 reading_box(const Config& config, const FootprintsInput& footprints) {
  if (!config.bounds.empty())
    return {config.bounds[0], config.bounds[1], config.bounds[2], config.bounds[3]};
  if (!footprints.bounds.empty()) return footprints.bounds.grown(config.domain_margin);
  const std::string why = footprints.dropped.empty()
                              ? "it is empty"
                              : fmt::format("feature {}: {}", footprints.dropped.front().source_id,
                                            footprints.dropped.front().reason);
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: holds no footprint ({}); {}give a file with the buildings' outlines as "
                  "polygons, or add --terrain-only for a mesh of the terrain alone",
                  config.footprints, why,
                  config.footprints_crs.empty() ? "" : "correct --footprints-crs, or "));
}

/// About how many points are in `box`, CRS coordinates, as far as headers tell.
double expected_points(const CloudHeaders& headers, const Bounds2& box) {
  double points = 0;
  for (const auto& [file, count] : headers.points) {
    const Bounds2 common = intersection(file, box);
    const double whole = file.width() * file.height();
    if (!common.empty() && whole > 0)
      points += static_cast<double>(count) * common.width() * common.height() / whole;
  }
  return points;
}

/// Refuses what cannot fit into memory, as far as is known. `box`: where the points are, CRS
/// coordinates.
void require_fits(const Config& config, const FootprintsInput& footprints, double points,
                  const Bounds2& box, Next next) {
  if (box.empty()) return;
  const double area = box.width() * box.height();
  CitySize size;
  size.area = area;
  size.height = config.domain_height;
  size.terrain_nodes = area / (config.dtm_step * config.dtm_step);
  require_points_fit(config, points, size.terrain_nodes);
  if (next != Next::kMesh) return;
  for (const Footprint& feature : footprints.features) {
    const Ring& outer = feature.polygon.outer;
    if (!outer.empty() && box.contains(outer.front())) size.add(feature.polygon);
  }
  require_mesh_fits(config, size);
}

void shift(FootprintsInput& footprints, Point2 origin) {
  const auto shift_ring = [&](Ring& ring) {
    for (Point2& p : ring) p = {p.x - origin.x, p.y - origin.y};
  };
  for (Footprint& feature : footprints.features) {
    shift_ring(feature.polygon.outer);
    for (Ring& hole : feature.polygon.holes) shift_ring(hole);
  }
}

/// Whole steps of the coordinate grid, rounded inwards.
Bounds2 snapped_inwards(const Bounds2& box) {
  const auto up = [](double x) {
    const double s = snap_coordinate(x);
    return s < x - kCoordinateStep / 1000 ? snap_coordinate(s + kCoordinateStep) : s;
  };
  const auto down = [](double x) {
    const double s = snap_coordinate(x);
    return s > x + kCoordinateStep / 1000 ? snap_coordinate(s - kCoordinateStep) : s;
  };
  return {up(box.xmin), up(box.ymin), down(box.xmax), down(box.ymax)};
}

/// The meshed rectangle, local frame.
Bounds2 find_domain(const Config& config, const FootprintsInput& footprints,
                    const PointsInput& points, Point2 origin) {
  Bounds2 domain;
  if (!config.bounds.empty()) {
    domain = {config.bounds[0] - origin.x, config.bounds[1] - origin.y, config.bounds[2] - origin.x,
              config.bounds[3] - origin.y};
  } else {
    domain = points.extent;
    if (!footprints.bounds.empty()) {
      const Bounds2 box{footprints.bounds.xmin - origin.x, footprints.bounds.ymin - origin.y,
                        footprints.bounds.xmax - origin.x, footprints.bounds.ymax - origin.y};
      domain =
          intersection(intersection(box, points.extent).grown(config.domain_margin), points.extent);
    }
  }
  domain = snapped_inwards(domain);
  require_room(config, domain, points_given(config),
               fmt::format(" (points in it: {})", points.points_kept));
  return domain;
}

/// The points' reference system as far as files and settings name it, in metres; "" if they do not.
std::string stated_points_crs(const Config& config, const CloudHeaders& headers,
                              const std::string& first_file) {
  const bool is_set = !config.points_crs.empty();
  std::string crs = normalise_crs(is_set ? config.points_crs : headers.crs);
  require_metres(crs, headers.crs_file.empty() ? first_file : headers.crs_file, "--points-crs");
  if (is_set)
    require_heights_in_metres(vertical_unit_metres(config.points_crs), "--points-crs",
                              "--points-crs");
  else
    require_heights_in_metres(headers.vertical_unit, headers.vertical_file, "--points-crs");
  return crs;
}

void fill_report(const Config& config, const FootprintsInput& footprints, const PointsInput& points,
                 std::size_t files, Report& report) {
  for (const std::vector<Warning>* warnings : {&footprints.warnings, &points.warnings})
    report.warnings.insert(report.warnings.end(), warnings->begin(), warnings->end());
  const auto has_height = [](const Footprint& feature) { return feature.height > 0; };
  if (!config.height_attribute.empty() &&
      std::none_of(footprints.features.begin(), footprints.features.end(), has_height))
    report.warnings.push_back({"height_attribute_empty",
                               static_cast<std::int64_t>(footprints.features.size()),
                               fmt::format("{}: attribute {} holds no number above 0",
                                           config.footprints, config.height_attribute)});
  InputReport& out = report.input.emplace();
  out.point_files = static_cast<std::int64_t>(files);
  out.point_files_skipped = points.files_skipped;
  out.points_read = points.points_read;
  out.points_kept = points.points_kept;
  out.points_by_class = points.points_by_class;
  out.footprints_read = footprints.features_read;
  out.footprint_parts =
      static_cast<std::int64_t>(footprints.features.size() + footprints.dropped.size());
}

[[noreturn]] void throw_no_points(const Config& config, const CloudHeaders& headers,
                                  const PointsInput& points, const std::optional<Bounds2>& crop) {
  if (!crop && points.points_read > 0)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: none of {} points is usable: all are noise (classes 7, 18) or "
                            "withheld; give other points",
                            points_given(config), points.points_read));
  const Bounds2 box = crop.value_or(headers.box);
  if (headers.box.empty())
    throw Error(ErrorKind::kInput,
                fmt::format("{}: the point cloud has no points", points_given(config)));
  if (points.points_read > 0 && headers.box.intersects(box))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: none of {} points is usable in the domain: all are noise "
                            "(classes 7, 18), withheld, or "
                            "outside of it ({})",
                            points_given(config), points.points_read, box_text(box)));
  throw Error(
      ErrorKind::kInput,
      fmt::format(
          "{}: points and domain do not overlap: the domain is {}, the points are {} by {}; check "
          "the CRS of both (--points-crs, --footprints-crs)",
          points_given(config), box_text(box), box_text(headers.box),
          config.points.size() == 1 ? "its header" : "the headers of all files"));
}

/// Points per square metre below which it is not the points that fill the box of their header.
constexpr double kSparse = 0.02;

/// Where to read points, and the origin of the local frame, before they are read. Refuses what will
/// not fit into memory, as far as headers can be believed.
ReadPointsOptions place_by_headers(const Config& config, const FootprintsInput& footprints,
                                   const CloudHeaders& headers, Next next) {
  ReadPointsOptions options;
  options.crs = config.points_crs;
  const Bounds2 box = reading_box(config, footprints);
  // Near the points even if a stray footprint lies on another continent: local numbers stay small.
  const Bounds2 common = headers.box.empty() ? box : intersection(box, headers.box);
  const Bounds2& near = common.empty() ? box : common;
  const double points = expected_points(headers, common);
  if (config.bounds.empty() && !(points > kSparse * common.width() * common.height()))
    require_points_fit(config, points, 0);
  else
    require_fits(config, footprints, points, common, next);
  options.crop = box;
  options.origin = Point2{std::floor(near.xmin), std::floor(near.ymin)};
  return options;
}

/// The same where nothing but the points tells where the domain is: headers may lie, so all are
/// read.
ReadPointsOptions read_everything(const Config& config, const CloudHeaders& headers) {
  double points = 0;
  for (const auto& [file, count] : headers.points) points += static_cast<double>(count);
  require_points_fit(config, points, 0);
  ReadPointsOptions options;
  options.crs = config.points_crs;
  return options;
}

/// Points far from all others do not tell where there are points: they become noise.
void leave_out_strays(const FootprintsInput& footprints, PointsInput& input, Report& report) {
  const auto [strays, rest] = find_stray_points(input.points, input.extent);
  PointCloud& cloud = input.points;
  // Where a building is, they are no strays.
  const auto is_at_building = [&](std::size_t p) {
    const Point2 at{cloud.x[p] + input.origin.x, cloud.y[p] + input.origin.y};
    return std::any_of(
        footprints.features.begin(), footprints.features.end(),
        [&](const Footprint& feature) { return bounds(feature.polygon).contains(at); });
  };
  if (strays.empty() || std::any_of(strays.begin(), strays.end(), is_at_building)) return;
  const std::size_t first = strays.front();
  report.warnings.push_back(
      {"stray_points", static_cast<std::int64_t>(strays.size()),
       fmt::format("points far from all others are left out, the first at ({:.2f}, {:.2f}); to "
                   "keep them, give --bounds",
                   cloud.x[first] + input.origin.x, cloud.y[first] + input.origin.y)});
  for (const std::size_t p : strays) cloud.classification[p] = kHighNoise;
  input.extent = rest;
}

/// Moves the origin, which is whole metres, to the south-western corner of the points.
void move_origin_to_corner(PointsInput& input) {
  const Point2 by{std::floor(input.extent.xmin), std::floor(input.extent.ymin)};
  for (PointCoordinate& x : input.points.x) x = x - by.x;
  for (PointCoordinate& y : input.points.y) y = y - by.y;
  input.extent = input.extent.moved({-by.x, -by.y});
  input.origin = {input.origin.x + by.x, input.origin.y + by.y};
}

/// Web Mercator and the like, in which a metre is no metre.
void warn_of_scale(const std::string& crs, const Bounds2& domain, Report& report) {
  constexpr double kMost = 0.01;  // ten times what usual systems have
  const double scale =
      length_scale(crs, {(domain.xmin + domain.xmax) / 2, (domain.ymin + domain.ymax) / 2});
  if (!(std::abs(scale - 1) > kMost)) return;
  report.warnings.push_back(
      {"crs_scale", 1,
       fmt::format("a metre of {} is {:.3f} m on the ground here, heights aside: footprints, "
                   "distances and the mesh are that much too {}; reproject to a national or UTM "
                   "system",
                   crs_name(crs), 1 / scale, scale > 1 ? "wide" : "narrow")});
}

}  // namespace

std::string points_given(const Config& config) {
  const std::string& first = config.points.front();
  return config.points.size() == 1
             ? first
             : fmt::format("{}, and {} more", first, config.points.size() - 1);
}

InputData read_input(const Config& config, Next next, StepClock& clock, Report& report,
                     std::string& misread) {
  const auto paths = expand_point_paths(config.points, &report.warnings);
  const CloudHeaders headers = read_headers(paths);
  const std::string points_crs = stated_points_crs(config, headers, paths.front().string());

  InputData input;
  input.footprints = read_all_footprints(config, points_crs, clock);
  if (config.bounds.empty()) leave_out_unusable(config, input.footprints);
  input.crs = common_crs(config, points_crs, input.footprints);
  if (input.crs.empty() || input.footprints.crs.empty())
    refuse_unmarked_degrees(input.footprints.bounds, config.footprints, "--footprints-crs");
  if (input.crs.empty())
    refuse_unmarked_degrees(headers.box, paths.front().string(), "--points-crs");

  const bool only_points_tell =
      config.terrain_only && config.bounds.empty() && input.footprints.bounds.empty();
  const ReadPointsOptions options = only_points_tell
                                        ? read_everything(config, headers)
                                        : place_by_headers(config, input.footprints, headers, next);
  PointsInput points = clock.run("1.1", "read points", [&](const Progress& progress) {
    return read_points(paths, options, progress);
  });
  misread = points.misread;
  fill_report(config, input.footprints, points, paths.size(), report);
  if (points.points_kept == 0) throw_no_points(config, headers, points, options.crop);
  if (config.bounds.empty()) leave_out_strays(input.footprints, points, report);
  constexpr double kFar = 10'000;  // metres: headers told of points where there are none
  const bool far = config.bounds.empty() && std::max(points.extent.xmin, points.extent.ymin) > kFar;
  if (only_points_tell || far) move_origin_to_corner(points);
  input.origin = points.origin;
  input.domain = find_domain(config, input.footprints, points, input.origin);
  report.domain = input.domain.moved(input.origin);
  if (config.bounds.empty())
    require_fits(config, input.footprints, static_cast<double>(points.points_kept), report.domain,
                 next);
  warn_of_scale(input.crs, report.domain, report);
  shift(input.footprints, input.origin);
  input.points = std::move(points.points);
  input.extent = points.extent;
  for (std::size_t f = 0; f < paths.size(); ++f)
    input.files.push_back({paths[f].string(), points.files[f]});
  return input;
}

}  // namespace tetropolis
