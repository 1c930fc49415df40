#include "read_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/metric_crs.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/raster/elevation.h"

#include "io/file/input_paths.h"
#include "io/las/text_points.h"
#include "io/vector/merge_footprints.h"
#include "memory_limit.h"
#include "mistaken_input.h"
#include "options_of.h"
#include "pipeline/common_crs.h"
#include "pipeline/footprint_extent.h"
#include "pipeline/memory.h"
#include "pipeline/require_metres.h"

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

/// Paths as they were given, for messages about all of them: "tiles, and 3 more".
std::string given_text(std::span<const std::string> paths) {
  if (paths.empty()) return {};
  return paths.size() == 1 ? paths.front()
                           : fmt::format("{}, and {} more", paths.front(), paths.size() - 1);
}

std::string points_given(const Config& config) { return given_text(config.points); }

/// What the headers of all clouds say together.
struct CloudHeaders {
  std::string crs;
  std::string crs_file;
  std::optional<double> vertical_unit;  ///< Of the first file that states one.
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

/// The same of points in memory.
CloudHeaders headers_of(const PointArrays& points) {
  CloudHeaders headers;
  headers.crs = points.crs;
  headers.crs_file = points.source;
  for (const auto& [x, y, z] : points.xyz)
    if (std::isfinite(x) && std::isfinite(y)) headers.box.extend(Point2{x, y});
  headers.points.emplace_back(headers.box, static_cast<std::int64_t>(points.xyz.size()));
  return headers;
}

double height_unit_metres(HeightUnit unit) {
  constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;
  if (unit == HeightUnit::kMetre) return 1;
  return unit == HeightUnit::kFoot ? kFoot : kSurveyFoot;
}

/// Folders that are data sets of their own, or of which a layer is named, stay folders.
std::vector<std::filesystem::path> footprint_paths(const Config& config) {
  std::error_code error;
  const auto is_data_set = [&](const std::string& path) {
    return std::filesystem::is_directory(path, error) &&
           (!config.layer.empty() || path.ends_with(".gdb") || path.ends_with(".gdb/"));
  };
  if (config.footprints.size() == 1 && is_data_set(config.footprints.front()))
    return {config.footprints.front()};
  return expand_paths(config.footprints, kVectorFiles);
}

FootprintsInput read_all_footprints(const Config& config, const InputInMemory& given,
                                    const std::string& points_crs, StepClock& clock) {
  if (config.footprints.empty()) return {};
  ReadFootprintsOptions options;
  options.layer = config.layer;
  options.id_attribute = config.id_attribute;
  options.height_attribute = config.height_attribute;
  options.floors_attribute = config.floors_attribute;
  options.floor_height = config.floor_height;
  options.height_unit = height_unit_metres(config.height_unit);
  options.where = config.where;
  options.source_crs = config.footprints_crs;
  options.target_crs = points_crs;
  options.attributes = true;
  return clock.run("1.2", "read footprints", [&](const Progress&) {
    if (given.footprints) return take_footprints(*given.footprints, options);
    const std::vector<std::filesystem::path> paths = footprint_paths(config);
    if (paths.size() == 1) return read_footprints(paths.front(), options);
    std::vector<FootprintsInput> all;
    for (const std::filesystem::path& path : paths) all.push_back(read_footprints(path, options));
    return merge_footprints(std::move(all), paths);
  });
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
                  "polygons, or add terrain_only for a mesh of the terrain alone",
                  given_text(config.footprints), why,
                  config.footprints_crs.empty() ? "" : "correct footprints_crs, or "));
}

/// About how many points are in `box`, CRS coordinates, as far as headers tell.
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

/// Refuses what cannot fit into memory, as far as is known. `box`: where the points are, CRS
/// coordinates.
void require_fits(const Config& config, const FootprintsInput& footprints, double points,
                  const Bounds2& box, Next next) {
  if (box.empty()) return;
  const double area = box.width() * box.height();
  CitySize size;
  size.area = area;
  size.height = config.domain_height > 0 ? config.domain_height : MeshCityOptions{}.domain_height;
  size.terrain_nodes = area / (config.dtm_step * config.dtm_step);
  require_points_fit({points, size.terrain_nodes, config.ground_margin}, memory_limit(config));
  if (next != Next::kMesh) return;
  for (const Footprint& feature : footprints.features) {
    const Ring& outer = feature.polygon.outer;
    if (!outer.empty() && box.contains(outer.front())) size.add(feature.polygon);
  }
  require_mesh_fits(mesh_options(config), size);
}

/// Metres per unit of coordinates and heights of a cloud.
struct CloudUnits {
  double across = 1;
  double up = 1;

  bool are_metres() const { return is_metre(across) && is_metre(up); }
};

Bounds2 scaled(const Bounds2& box, double by) {
  if (box.empty()) return box;
  return {box.xmin * by, box.ymin * by, box.xmax * by, box.ymax * by};
}

/// The points' reference system as far as files and settings name it, in metres; "" if they do not.
/// Boxes of the headers become those in metres. Where points are in feet, `units` tell and a
/// warning.
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

/// Of a cloud that was read in other units.
void convert_to_metres(const CloudUnits& units, PointsInput& input) {
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
          "the CRS of both (points_crs, footprints_crs)",
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
  const Bounds2 common = headers.box.empty() ? box : box.intersection(headers.box);
  const Bounds2& near = common.empty() ? box : common;
  const double points = expected_points(headers, common);
  if (config.bounds.empty() && !(points > kSparse * common.width() * common.height()))
    require_points_fit({points, 0, config.ground_margin}, memory_limit(config));
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
  require_points_fit({points, 0, config.ground_margin}, memory_limit(config));
  ReadPointsOptions options;
  options.crs = config.points_crs;
  return options;
}

/// Points of which none is usable lead to an error here, as misread ones do to one later.
void require_points(const Config& config, const CloudHeaders& headers, const PointsInput& points,
                    const std::optional<Bounds2>& crop) {
  if (points.points_kept > 0) return;
  try {
    throw_no_points(config, headers, points, crop);
  } catch (const Error& error) {
    if (points.misread.empty()) throw;
    throw Error(error.kind(), std::string(error.what()) + "; " + points.misread);
  }
}

/// Where the user wants no footprint that is off for want of a grid.
void require_grids(const Config& config, const FootprintsInput& footprints) {
  if (!config.require_grids) return;
  for (const Warning& warning : footprints.warnings)
    if (warning.code == "grid_missing")
      throw Error(ErrorKind::kInput, warning.message + " (require_grids)");
}

void warn_of_heights(const Config& config, const FootprintsInput& footprints,
                     std::vector<Warning>& warnings) {
  const auto has_height = [](const Footprint& feature) { return feature.height > 0; };
  if (config.height_attribute.empty() ||
      std::any_of(footprints.features.begin(), footprints.features.end(), has_height))
    return;
  warnings.push_back({"height_attribute_empty",
                      static_cast<std::int64_t>(footprints.features.size()),
                      fmt::format("{}: attribute {} holds no number above 0",
                                  given_text(config.footprints), config.height_attribute)});
}

/// What the headers of rasters say together.
struct RasterHeaders {
  std::vector<std::filesystem::path> terrain, surface;
  std::string crs;                   ///< Of the first that states one.
  Bounds2 box = Bounds2::nothing();  ///< Of surface, else of terrain, in `crs`.
};

RasterHeaders read_raster_headers(const Config& config) {
  RasterHeaders headers;
  const std::string given = normalise_crs(config.raster_crs);
  const auto read = [&](const std::vector<std::string>& arguments) {
    const auto paths = expand_raster_paths(arguments);
    Bounds2 box = Bounds2::nothing();
    std::string crs;
    for (const std::filesystem::path& path : paths) {
      const RasterHeader header = inspect_raster(path);
      const std::string& own = given.empty() ? header.crs : given;
      if (box.empty()) crs = own;
      if (own == crs) box.extend(header.box);
    }
    if (!paths.empty()) {
      headers.crs = crs;
      headers.box = box;
    }
    return paths;
  };
  headers.terrain = read(config.dtm);
  const std::string of_terrain = headers.crs;
  headers.surface = read(config.dsm);
  if (headers.crs.empty()) headers.crs = of_terrain;
  return headers;
}

/// Whether lengths in a system are lengths on the ground, nearly.
bool is_true_to_scale(const std::string& crs, const Bounds2& box) {
  constexpr double kMost = 0.01;
  const double scale = length_scale(crs, {(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2});
  return !(std::abs(scale - 1) > kMost);
}

/// The system of a city without points: that of the rasters, else of the footprints; in metres.
std::string system_without_points(const RasterHeaders& rasters, const FootprintsInput& footprints,
                                  std::vector<Warning>& warnings) {
  const bool of_raster = !rasters.crs.empty();
  const std::string& stated = of_raster ? rasters.crs : footprints.crs;
  const Bounds2& box = of_raster ? rasters.box : footprints.bounds;
  if (stated.empty() || box.empty()) return stated;
  std::string crs;
  if (!is_geographic(stated)) {
    crs = in_metres(stated);
    if (is_metre(linear_unit_metres(stated)) && is_true_to_scale(stated, box)) return crs;
    if (is_true_to_scale(stated, box)) {
      warnings.push_back(
          {"crs_in_metres", 1,
           fmt::format("{} is in units of {:.10g} m; the city is in {}", crs_name(stated),
                       linear_unit_metres(stated), crs_name(crs))});
      return crs;
    }
  }
  const std::vector<Point2> middle{{(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2}};
  const Point2 place =
      is_geographic(stated) ? middle.front() : reproject(middle, stated, "EPSG:4326").front();
  crs = utm_zone(place);
  warnings.push_back({"crs_chosen", 1,
                      fmt::format("{} is not in metres on the ground; the city is in {} (UTM)",
                                  crs_name(stated), crs_name(crs))});
  return crs;
}

TerrainInput read_terrain(const Config& config, const RasterHeaders& rasters,
                          const std::string& crs, const Bounds2& box, Point2 origin,
                          std::vector<Warning>& warnings) {
  TerrainInput terrain;
  terrain.source = given_text(config.dtm);
  terrain.origin = origin;
  ReadElevationsOptions options;
  options.source_crs = config.raster_crs;
  options.target_crs = crs;
  options.box = box;
  options.origin = origin;
  Elevations read = read_elevations(rasters.terrain, options);
  terrain.crs = crs;
  terrain.raster = std::move(read.raster);
  warnings.insert(warnings.end(), read.warnings.begin(), read.warnings.end());
  fill_with_nearest(terrain.raster);
  if (read.missing > 0)
    warnings.push_back({"raster_filled", read.missing,
                        fmt::format("{}: {} of {} pixels have no value; they take the nearest one",
                                    terrain.source, read.missing, terrain.raster.values.size())});
  return terrain;
}

/// A point per cell of a surface.
PointsInput read_surface(const Config& config, const RasterHeaders& rasters, const std::string& crs,
                         const Bounds2& box, Point2 origin) {
  ReadElevationsOptions options;
  options.source_crs = config.raster_crs;
  options.target_crs = crs;
  options.box = box;
  options.origin = origin;
  options.resampling = Resampling::kNearest;
  const Elevations read = read_elevations(rasters.surface, options);
  PointsInput input;
  input.source = given_text(config.dsm);
  input.origin = origin;
  input.crs = crs;
  input.warnings = read.warnings;
  const Raster& raster = read.raster;
  const Bounds2 local = box.empty() ? raster.bounds() : box.moved({-origin.x, -origin.y});
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i) {
      const Point2 p{raster.x0 + i * raster.step, raster.y0 + j * raster.step};
      const double z = raster.at(i, j);
      if (std::isnan(z) || !local.contains(p)) continue;
      input.points.x.push_back(PointCoordinate(p.x));
      input.points.y.push_back(PointCoordinate(p.y));
      input.points.z.push_back(PointCoordinate(z));
      input.points.classification.push_back(kUnclassified);
      input.extent.extend(p);
    }
  input.points_read = static_cast<std::int64_t>(raster.values.size());
  input.points_kept = static_cast<std::int64_t>(input.points.size());
  input.points_by_class[kUnclassified] = input.points_kept;
  return input;
}

/// Level ground, where nothing tells of another.
TerrainInput level_ground(const Config& config, const std::string& crs, const Bounds2& box,
                          Point2 origin, std::vector<Warning>& warnings) {
  TerrainInput terrain;
  terrain.source = "level ground";
  terrain.origin = origin;
  terrain.crs = crs;
  terrain.raster = {1,
                    1,
                    (box.xmin + box.xmax) / 2 - origin.x,
                    (box.ymin + box.ymax) / 2 - origin.y,
                    1,
                    {config.ground_level}};
  warnings.push_back({"ground_level", 1,
                      fmt::format("no terrain is given: the ground is level at {:g} m "
                                  "(ground_level); give a raster with `dtm`",
                                  config.ground_level)});
  return terrain;
}

/// Whether all points are in text or PLY files; throws where only some are.
bool are_plain_points(const Config& config) {
  const auto plain = std::count_if(config.points.begin(), config.points.end(), is_plain_points);
  if (plain != 0 && plain != std::ssize(config.points))
    throw Error(ErrorKind::kInput, points_given(config) +
                                       ": XYZ and PLY files cannot be read together with LAS "
                                       "files; convert them to one format");
  return plain > 0;
}

/// Of text and PLY files, as if they were given in memory.
PlainPoints read_all_plain(const Config& config) {
  PlainPoints all;
  bool classed = true;
  for (const std::filesystem::path& path : expand_paths(config.points, {})) {
    const PlainPoints one = read_plain_points(path);
    all.xyz.insert(all.xyz.end(), one.xyz.begin(), one.xyz.end());
    all.classification.insert(all.classification.end(), one.classification.begin(),
                              one.classification.end());
    classed = classed && !one.classification.empty();
  }
  if (!classed) all.classification.clear();
  return all;
}

/// Without points: rasters and footprints.
RunInput read_without_points(const Config& config, Next next, StepClock& clock,
                             std::vector<Warning>& warnings, const InputInMemory& given) {
  const RasterHeaders rasters = read_raster_headers(config);
  RunInput input;
  input.footprints = read_all_footprints(config, given, {}, clock);
  const std::string crs = system_without_points(rasters, input.footprints, warnings);
  if (!crs.empty() && !input.footprints.crs.empty()) reproject_footprints(input.footprints, crs);
  require_grids(config, input.footprints);
  warn_of_heights(config, input.footprints, warnings);
  if (config.bounds.empty()) bound_by_extent(input.footprints, config.parallel_tolerance);
  if (crs.empty() || input.footprints.crs.empty())
    refuse_unmarked_degrees(input.footprints.bounds, given_text(config.footprints),
                            "footprints_crs");
  refuse_degree_bounds(config, crs, input.footprints.bounds);
  const bool only_rasters_tell =
      config.terrain_only && config.bounds.empty() && input.footprints.bounds.empty();
  Bounds2 box = Bounds2::nothing();
  if (!only_rasters_tell) box = reading_box(config, input.footprints);
  Point2 origin{};
  if (!box.empty()) {
    origin = {std::floor(box.xmin), std::floor(box.ymin)};
  } else if (!rasters.box.empty()) {
    const Point2 corner{rasters.box.xmin, rasters.box.ymin};
    const bool moves = !crs.empty() && !rasters.crs.empty() && rasters.crs != crs;
    const Point2 at = moves ? reproject(std::span(&corner, 1), rasters.crs, crs).front() : corner;
    if (std::isfinite(at.x)) origin = {std::floor(at.x), std::floor(at.y)};
  }
  input.has_surface = !rasters.surface.empty();
  if (input.has_surface)
    input.points = clock.run("1.1", "read surface", [&](const Progress&) {
      return read_surface(config, rasters, crs, box, origin);
    });
  input.points.origin = origin;
  input.points.crs = crs;
  if (!rasters.terrain.empty())
    input.terrain = clock.run("1.1", "read terrain", [&](const Progress&) {
      return read_terrain(config, rasters, crs, box, origin, warnings);
    });
  else if (rasters.surface.empty())
    input.terrain = level_ground(config, crs, box, origin, warnings);
  if (!box.empty())
    require_fits(config, input.footprints, static_cast<double>(input.points.points.size()), box,
                 next);
  if (input.points.points.size() == 0 && input.terrain)
    input.points.extent =
        box.empty() ? input.terrain->raster.bounds() : box.moved({-origin.x, -origin.y});
  return input;
}

}  // namespace

RunInput read_input(const Config& config, Next next, StepClock& clock,
                    std::vector<Warning>& warnings, const InputInMemory& given) {
  if (config.points.empty()) return read_without_points(config, next, clock, warnings, given);
  if (!given.points && are_plain_points(config)) {
    const PlainPoints plain =
        clock.run("1.1", "read points", [&](const Progress&) { return read_all_plain(config); });
    InputInMemory in_memory = given;
    in_memory.points = PointArrays{plain.xyz, plain.classification, {}, points_given(config)};
    return read_input(config, next, clock, warnings, in_memory);
  }
  const auto paths = given.points ? std::vector<std::filesystem::path>{given.points->source}
                                  : expand_point_paths(config.points, &warnings);
  CloudHeaders headers = given.points ? headers_of(*given.points) : read_headers(paths);
  CloudUnits units;
  const std::string points_crs = stated_points_crs(
      config, paths.front().string(), given.points.has_value(), headers, units, warnings);

  RunInput input;
  input.footprints = read_all_footprints(config, given, points_crs, clock);
  require_grids(config, input.footprints);
  warn_of_heights(config, input.footprints, warnings);
  if (config.bounds.empty()) bound_by_extent(input.footprints, config.parallel_tolerance);
  const std::string crs = common_crs(points_crs, input.footprints);
  if (crs.empty() || input.footprints.crs.empty())
    refuse_unmarked_degrees(input.footprints.bounds, given_text(config.footprints),
                            "footprints_crs");
  if (crs.empty()) refuse_unmarked_degrees(headers.box, paths.front().string(), "points_crs");

  refuse_degree_bounds(config, crs, headers.box);
  const bool only_points_tell =
      config.terrain_only && config.bounds.empty() && input.footprints.bounds.empty();
  const ReadPointsOptions options = only_points_tell
                                        ? read_everything(config, headers)
                                        : place_by_headers(config, input.footprints, headers, next);
  input.points = clock.run("1.1", "read points", [&](const Progress& progress) {
    ReadPointsOptions reading = options;
    if (!units.are_metres()) {
      reading.crs.clear();
      if (reading.crop) reading.crop = scaled(*reading.crop, 1 / units.across);
      if (reading.origin)
        reading.origin = Point2{std::floor(reading.origin->x / units.across),
                                std::floor(reading.origin->y / units.across)};
    }
    PointsInput points =
        given.points ? take_points(*given.points, reading) : read_points(paths, reading, progress);
    if (!units.are_metres()) convert_to_metres(units, points);
    return points;
  });
  require_points(config, headers, input.points, options.crop);
  input.points.crs = points_crs;
  input.points.source = points_given(config);
  if (!config.dtm.empty())
    input.terrain = clock.run("1.1", "read terrain", [&](const Progress&) {
      const RasterHeaders rasters = read_raster_headers(config);
      const std::string target = points_crs.empty() ? crs : points_crs;
      return read_terrain(config, rasters, target.empty() ? rasters.crs : target,
                          options.crop.value_or(Bounds2::nothing()), input.points.origin, warnings);
    });
  return input;
}

}  // namespace tetropolis
