#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/geo_place.h"

#include "city_input.h"
#include "common_crs.h"
#include "default_domain.h"
#include "footprint_extent.h"
#include "io/vector/vector_geometry.h"
#include "require_room.h"
#include "require_terrain.h"
#include "stray_points.h"

namespace tetropolis {

namespace {

void shift(FootprintsInput& footprints, Point2 origin) {
  for (Footprint& feature : footprints.features)
    for_each_position(feature, [&](Point2& p) { p = {p.x - origin.x, p.y - origin.y}; });
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
Bounds2 find_domain(const BuildCityOptions& options, const FootprintsInput& footprints,
                    const PointsInput& points) {
  Bounds2 domain = points.extent;
  if (options.bounds) {
    domain = options.bounds->moved({-points.origin.x, -points.origin.y});
  } else if (!footprints.bounds.empty()) {
    domain = default_domain(options, footprints, points.extent, points.origin);
  }
  domain = snapped_inwards(domain);
  require_room(options.simplify.min_distance, domain, points.source,
               fmt::format(" (points in it: {})", points.points.size()));
  return domain;
}

/// Points far from all others do not tell where there are points: they become noise.
void leave_out_strays(const FootprintsInput& footprints, PointsInput& input,
                      std::vector<Warning>& warnings) {
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
  warnings.push_back(
      {"stray_points", static_cast<std::int64_t>(strays.size()),
       fmt::format("{} points far from all others are left out, the first at ({:.2f}, {:.2f}); to "
                   "keep them, give `bounds`",
                   strays.size(), cloud.x[first] + input.origin.x,
                   cloud.y[first] + input.origin.y)});
  for (const std::size_t p : strays) cloud.classification[p] = kHighNoise;
  input.extent = rest;
}

/// Moves the origin by whole metres.
void move_origin(Point2 by, PointsInput& input) {
  for (PointCoordinate& x : input.points.x) x = x - by.x;
  for (PointCoordinate& y : input.points.y) y = y - by.y;
  input.extent = input.extent.moved({-by.x, -by.y});
  input.origin = {input.origin.x + by.x, input.origin.y + by.y};
}

/// From the points' origin to another one. Throws Error(kUsage) if points are too far from that.
Point2 way_to(Point2 origin, const PointsInput& input) {
  const Point2 by{origin.x - input.origin.x, origin.y - input.origin.y};
  const Bounds2 box = input.extent.moved({-by.x, -by.y});
  constexpr double kMost = PointCoordinate::kMost / 2;
  if (!Bounds2{-kMost, -kMost, kMost, kMost}.covers(box))
    throw Error(
        ErrorKind::kUsage,
        fmt::format("origin: ({:.0f}, {:.0f}) is more than {:.0f} km from the points, which "
                    "lie at ({:.0f}, {:.0f}); give one near them",
                    origin.x, origin.y, kMost / 1000, input.extent.xmin + input.origin.x,
                    input.extent.ymin + input.origin.y));
  return by;
}

/// Web Mercator and the like, in which a metre is no metre.
void warn_of_scale(const std::string& crs, const Bounds2& domain, std::vector<Warning>& warnings) {
  constexpr double kMost = 0.01;  // ten times what usual systems have
  const double scale =
      length_scale(crs, {(domain.xmin + domain.xmax) / 2, (domain.ymin + domain.ymax) / 2});
  if (!(std::abs(scale - 1) > kMost)) return;
  warnings.push_back(
      {"crs_scale", 1,
       fmt::format(
           "{} distorts lengths here: 1 unit = {:.3f} m on the ground, so footprints, distances "
           "and the mesh are too {} by that; reproject to a national or UTM system",
           crs_name(crs), 1 / scale, scale > 1 ? "wide" : "narrow")});
}

/// A wrong CRS shows as a place where it is not used.
void warn_of_place(const std::string& crs, const Bounds2& domain, std::vector<Warning>& warnings) {
  const auto place = place_of(crs, domain);
  if (!place || place->is_in_area) return;
  warnings.push_back({"crs_elsewhere", 1,
                      fmt::format("in {} the data lie at {}, where it is not used; is it another "
                                  "one? (points_crs, footprints_crs)",
                                  crs_name(crs), position_text(*place))});
}

/// Throws Error(kInput) unless each feature has an id of its own.
void require_ids(const FootprintsInput& footprints) {
  std::set<std::string_view> ids;
  const auto require = [&](const auto& features) {
    for (const auto& feature : features)
      if (feature.source_id.empty() || !ids.insert(feature.source_id).second)
        throw Error(ErrorKind::kInput,
                    fmt::format("{}: {} footprint has the source_id '{}'; give each one of its own",
                                footprints.source, feature.source_id.empty() ? "a" : "a second",
                                feature.source_id));
  };
  require(footprints.features);
  require(footprints.dropped);
}

/// Counts and box, where a caller that has made the cloud of arrays gives none.
void complete(PointsInput& points) {
  const PointCloud& cloud = points.points;
  points.points_kept = static_cast<std::int64_t>(cloud.size());
  if (points.points_by_class.empty())
    for (const std::uint8_t code : cloud.classification) ++points.points_by_class[code];
  if (!points.extent.empty()) return;
  for (std::size_t p = 0; p < cloud.size(); ++p)
    points.extent.extend(Point2{cloud.x[p], cloud.y[p]});
}

bool is_level(const TerrainInput& terrain) { return terrain.raster.values.size() == 1; }

/// Of the pixels, CRS coordinates.
Bounds2 extent_of(const TerrainInput& terrain) {
  return terrain.raster.bounds().grown(terrain.raster.step / 2).moved(terrain.origin);
}

/// What the points say of reference system and place, where there are none.
void stand_in(const TerrainInput& terrain, const FootprintsInput& footprints,
              const BuildCityOptions& options, PointsInput& points) {
  if (points.crs.empty()) points.crs = terrain.crs;
  points.source = is_level(terrain) ? footprints.source : terrain.source;
  if (!points.extent.empty()) return;
  Bounds2 known = extent_of(terrain);
  if (is_level(terrain)) {
    const Bounds2 wanted = options.bounds.value_or(footprints.bounds);
    known = wanted.empty() ? wanted : wanted.grown(options.domain_margin);
  }
  if (known.empty())
    throw Error(ErrorKind::kInput, footprints.source +
                                       ": nothing tells where the domain is; give "
                                       "`bounds`, points or a terrain");
  points.origin = {std::floor(known.xmin), std::floor(known.ymin)};
  points.extent = known.moved({-points.origin.x, -points.origin.y});
}

/// The domain is to have terrain, of which the raster beyond its rim is a guess.
void hold_against_terrain(const BuildCityOptions& options, const TerrainInput& terrain,
                          PointsInput& points, std::vector<Warning>& warnings) {
  if (!points.crs.empty() && !terrain.crs.empty() && !same_horizontal_crs(points.crs, terrain.crs))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: the terrain is in {}, the points in {}; read it with target_crs",
                            terrain.source, crs_name(terrain.crs), crs_name(points.crs)));
  if (is_level(terrain)) return;
  const Bounds2 covered = extent_of(terrain);
  const Bounds2 wanted = options.bounds.value_or(points.extent.moved(points.origin));
  const Bounds2 common = wanted.intersection(covered);
  if (common.empty() || !(common.width() > 0) || !(common.height() > 0))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: the terrain, x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}, does not "
                            "overlap the domain, x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}; check the "
                            "CRS of both (raster_crs, footprints_crs)",
                            terrain.source, covered.xmin, covered.xmax, covered.ymin, covered.ymax,
                            wanted.xmin, wanted.xmax, wanted.ymin, wanted.ymax));
  if (!options.bounds) {
    points.extent = common.moved({-points.origin.x, -points.origin.y});
    return;
  }
  const double beyond = 1 - common.width() * common.height() / (wanted.width() * wanted.height());
  constexpr double kTold = 0.01;
  if (beyond > kTold)
    warnings.push_back({"terrain_beyond_raster", 1,
                        fmt::format("{}: {:.0f} % of the domain lie beyond this terrain and take "
                                    "the heights of its rim; give smaller `bounds` or more tiles",
                                    terrain.source, 100 * beyond)});
}

}  // namespace

CityInput place_input(CitySources sources, const BuildCityOptions& options,
                      std::vector<Warning>& warnings) {
  PointsInput& points = sources.points;
  FootprintsInput& footprints = sources.footprints;
  if (sources.terrain) require_raster(sources.terrain->raster, sources.terrain->source);
  const bool has_points = points.points.size() > 0;
  if (!has_points && !sources.terrain)
    throw Error(ErrorKind::kInput, points.files.empty()
                                       ? "no points and no terrain; give one"
                                       : points.source + ": the point cloud has no points");
  require_ids(footprints);
  if (footprints.bounds.empty())
    for (const Footprint& feature : footprints.features)
      footprints.bounds.extend(bounds(feature.polygon));
  if (has_points)
    complete(points);
  else
    stand_in(*sources.terrain, footprints, options, points);
  CityInput input;
  input.crs = common_crs(points, footprints);
  if (points.crs.empty() && has_points)
    warnings.push_back(
        {"points_crs_unknown", 1,
         points.source + ": the points have no CRS" +
             (input.crs.empty()
                  ? "; their coordinates are taken for metres; name it with points_crs"
                  : fmt::format(": taken from the footprints ({}); if it is another, name it with "
                                "points_crs",
                                crs_name(input.crs)))});
  if (!options.bounds) {
    bound_by_extent(footprints, options.simplify.parallel_tolerance);
    if (has_points) leave_out_strays(footprints, points, warnings);
  }
  if (sources.terrain) hold_against_terrain(options, *sources.terrain, points, warnings);
  const bool only_points_tell = !options.bounds && footprints.bounds.empty();
  constexpr double kFar = 10'000;  // metres: headers told of points where there are none
  const bool far = !options.bounds && std::max(points.extent.xmin, points.extent.ymin) > kFar;
  if (options.origin)
    move_origin(way_to(*options.origin, points), points);
  else if (only_points_tell || far)
    move_origin({std::floor(points.extent.xmin), std::floor(points.extent.ymin)}, points);
  input.domain = find_domain(options, footprints, points);
  if (!options.bounds) input.covered = points.extent;
  warn_of_scale(input.crs, input.domain.moved(points.origin), warnings);
  warn_of_place(input.crs, input.domain.moved(points.origin), warnings);
  shift(footprints, points.origin);
  input.has_surface = sources.has_surface;
  if (sources.terrain) {
    input.terrain = std::move(sources.terrain);
    input.terrain->raster.x0 += input.terrain->origin.x - points.origin.x;
    input.terrain->raster.y0 += input.terrain->origin.y - points.origin.y;
    input.terrain->origin = points.origin;
  }
  input.points = std::move(points);
  input.footprints = std::move(footprints);
  return input;
}

}  // namespace tetropolis
