#include "read_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/las/las.h"

#include "cloud_headers.h"
#include "core/text.h"
#include "io/file/input_paths.h"
#include "io/las/text_points.h"
#include "io/vector/merge_footprints.h"
#include "memory_limit.h"
#include "mistaken_input.h"
#include "options_of.h"
#include "pipeline/common_crs.h"
#include "pipeline/footprint_extent.h"
#include "pipeline/ground_of_bases.h"
#include "pipeline/memory.h"
#include "read_planned.h"
#include "read_rasters.h"

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

std::string points_given(const Config& config) { return given_text(config.points); }

std::string outlines_given(const Config& config) {
  return given_text(config.footprints.empty() ? config.planned : config.footprints);
}

double height_unit_metres(HeightUnit unit) {
  constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;
  if (unit == HeightUnit::kMetre) return 1;
  return unit == HeightUnit::kFoot ? kFoot : kSurveyFoot;
}

/// A folder of which a layer is named stays one.
std::vector<std::filesystem::path> footprint_paths(const Config& config) {
  std::error_code error;
  if (config.footprints.size() == 1 && !config.layer.empty() &&
      std::filesystem::is_directory(config.footprints.front(), error))
    return {config.footprints.front()};
  return expand_paths(config.footprints, kVectorFiles);
}

/// The box of the settings, if there is one.
Bounds2 stated_box(const Config& config) {
  if (config.bounds.empty()) return Bounds2::nothing();
  return {config.bounds[0], config.bounds[1], config.bounds[2], config.bounds[3]};
}

/// Of a folder with files named after buildings, as of an extract by themes, only these are kept.
void keep_files_of_buildings(const Config& config, std::vector<std::filesystem::path>& paths,
                             std::vector<Warning>& warnings) {
  std::error_code error;
  if (config.footprints.size() > 1 ||
      !std::filesystem::is_directory(config.footprints.front(), error))
    return;
  const auto others =
      std::stable_partition(paths.begin(), paths.end(), [](const std::filesystem::path& path) {
        return lower_case(path.filename().string()).find("building") != std::string::npos;
      });
  if (others == paths.begin() || others == paths.end()) return;
  warnings.push_back(
      {"files_of_buildings", paths.end() - others,
       fmt::format("{}: {} files without 'building' in their names are not read "
                   "(first: {}); name them if they hold buildings",
                   config.footprints.front(), paths.end() - others, others->filename().string())});
  paths.erase(others, paths.end());
}

FootprintsInput read_existing(const Config& config, const InputInMemory& given,
                              const ReadFootprintsOptions& options) {
  if (given.footprints) return take_footprints(*given.footprints, options);
  if (config.footprints.empty()) return {};
  std::vector<std::filesystem::path> paths = footprint_paths(config);
  std::vector<Warning> warnings;
  keep_files_of_buildings(config, paths, warnings);
  std::vector<FootprintsInput> all;
  for (const std::filesystem::path& path : paths) all.push_back(read_footprints(path, options));
  FootprintsInput input =
      all.size() == 1 ? std::move(all.front()) : merge_footprints(std::move(all), paths);
  input.warnings.insert(input.warnings.end(), warnings.begin(), warnings.end());
  return input;
}

/// `target_crs`: what they are reprojected to; empty: as they are. `city_crs`: of the settings'
/// bounds, if known; `own_crs_first`: they are in that of the footprints, if that can be.
FootprintsInput read_all_footprints(const Config& config, const InputInMemory& given,
                                    const std::string& target_crs, const std::string& city_crs,
                                    bool own_crs_first, StepClock& clock) {
  if (config.footprints.empty() && config.planned.empty()) return {};
  ReadFootprintsOptions options;
  options.layer = config.layer;
  options.id_attribute = config.id_attribute;
  options.height_attribute = config.height_attribute;
  options.floors_attribute = config.floors_attribute;
  options.floor_height = config.floor_height;
  options.height_unit = height_unit_metres(config.height_unit);
  options.where = config.where;
  options.source_crs = config.footprints_crs;
  options.target_crs = target_crs;
  options.attributes = true;
  // Bounds in degrees by mistake are told from what the data are.
  constexpr Bounds2 kDegrees{-180, -180, 180, 180};
  if (const Bounds2 box = stated_box(config); !kDegrees.covers(box)) options.within = box;
  options.within_crs = city_crs;
  options.own_crs_first = own_crs_first;
  return clock.run("1.2", "read footprints", [&](const Progress&) {
    FootprintsInput footprints = read_existing(config, given, options);
    add_planned(config, options, footprints);
    return footprints;
  });
}

/// The box in which points can matter, CRS coordinates.
Bounds2 reading_box(const Config& config, const FootprintsInput& footprints) {
  if (!config.bounds.empty()) return stated_box(config);
  if (!footprints.bounds.empty()) return footprints.bounds.grown(config.domain_margin);
  const std::string why = footprints.dropped.empty()
                              ? (config.where.empty() ? "it is empty" : "none meets `where`")
                              : fmt::format("feature {}: {}", footprints.dropped.front().source_id,
                                            footprints.dropped.front().reason);
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: holds no footprint ({}); {}give a file with the buildings' outlines as "
                  "polygons, or add terrain_only for a mesh of the terrain alone",
                  outlines_given(config), why,
                  config.footprints_crs.empty() ? "" : "correct footprints_crs, or "));
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
  // Of sizes that differ by place, mesh_city knows more.
  if (next != Next::kMesh || config.far_size > 0 || !config.refine.empty()) return;
  for (const Footprint& feature : footprints.features) {
    const Ring& outer = feature.polygon.outer;
    if (!feature.is_cleared() && !outer.empty() && box.contains(outer.front()))
      size.add(feature.polygon);
  }
  require_mesh_fits(mesh_options(config), size);
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
  const auto has_height = [](const Footprint& feature) {
    return feature.height > 0 && !feature.is_planned;
  };
  if (config.height_attribute.empty() ||
      std::any_of(footprints.features.begin(), footprints.features.end(), has_height))
    return;
  warnings.push_back({"height_attribute_empty",
                      static_cast<std::int64_t>(footprints.features.size()),
                      fmt::format("{}: attribute {} holds no number above 0",
                                  outlines_given(config), config.height_attribute)});
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

/// Of the bases of city models, unless level ground is asked for.
TerrainInput ground_without_rasters(const Config& config, const FootprintsInput& footprints,
                                    const std::string& crs, const Bounds2& box, Point2 origin,
                                    std::vector<Warning>& warnings) {
  if (config.ground_level == 0) {
    if (auto terrain = ground_of_bases(footprints, box, origin, config.dtm_step, warnings))
      return *std::move(terrain);
  }
  return level_ground(config, crs, box, origin, warnings);
}

/// Without points: rasters and footprints.
RunInput read_without_points(const Config& config, Next next, StepClock& clock,
                             std::vector<Warning>& warnings, const InputInMemory& given) {
  const RasterHeaders rasters = read_raster_headers(config);
  RunInput input;
  std::vector<Warning> told_below;
  const std::string raster_crs =
      rasters.crs.empty() ? rasters.crs : system_without_points(rasters, {}, told_below);
  input.footprints =
      read_all_footprints(config, given, {}, raster_crs, !tells_system(rasters), clock);
  const std::string crs = system_without_points(rasters, input.footprints, warnings);
  if (!crs.empty() && !input.footprints.crs.empty()) reproject_footprints(input.footprints, crs);
  require_grids(config, input.footprints);
  warn_of_heights(config, input.footprints, warnings);
  if (config.bounds.empty()) bound_by_extent(input.footprints, config.parallel_tolerance);
  if (crs.empty() || input.footprints.crs.empty())
    refuse_unmarked_degrees(input.footprints.bounds, outlines_given(config), "footprints_crs");
  refuse_degree_bounds(
      config, crs,
      rasters.box.empty() ? input.footprints.bounds : reproject_box(rasters.box, rasters.crs, crs));
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
  if (!box.empty())
    require_fits(config, input.footprints, static_cast<double>(input.points.points.size()), box,
                 next);
  if (rasters.terrain.empty() && rasters.surface.empty())
    input.terrain = clock.run("1.3", "ground without rasters", [&](const Progress&) {
      return ground_without_rasters(config, input.footprints, crs, box, origin, warnings);
    });
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
  input.footprints = read_all_footprints(config, given, points_crs, points_crs, false, clock);
  require_grids(config, input.footprints);
  warn_of_heights(config, input.footprints, warnings);
  if (config.bounds.empty()) bound_by_extent(input.footprints, config.parallel_tolerance);
  const std::string crs = common_crs(points_crs, input.footprints);
  if (crs.empty() || input.footprints.crs.empty())
    refuse_unmarked_degrees(input.footprints.bounds, outlines_given(config), "footprints_crs");
  if (crs.empty()) refuse_unmarked_degrees(headers.box, paths.front().string(), "points_crs");

  refuse_degree_bounds(config, crs, headers.box);
  const bool only_points_tell =
      config.terrain_only && config.bounds.empty() && input.footprints.bounds.empty();
  const ReadPointsOptions options = only_points_tell
                                        ? read_everything(config, headers)
                                        : place_by_headers(config, input.footprints, headers, next);
  input.points = clock.run("1.1", "read points", [&](const Progress& progress) {
    const ReadPointsOptions reading = in_units(units, options);
    PointsInput points =
        given.points ? take_points(*given.points, reading) : read_points(paths, reading, progress);
    convert_to_metres(units, points);
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
