#include "read_rasters.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/metric_crs.h"
#include "tetropolis/io/raster/elevation.h"

#include "io/file/input_paths.h"

namespace tetropolis {

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

namespace {

/// Whether lengths in a system are those on the ground, in metres or another unit.
bool is_projected(const std::string& crs, const Bounds2& box) {
  return !crs.empty() && !is_geographic(crs) && (box.empty() || is_true_to_scale(crs, box));
}

}  // namespace

bool tells_system(const RasterHeaders& rasters) { return is_projected(rasters.crs, rasters.box); }

std::string system_without_points(const RasterHeaders& rasters, const FootprintsInput& footprints,
                                  std::vector<Warning>& warnings) {
  const bool of_raster = tells_system(rasters) ||
                         (!rasters.crs.empty() && !is_projected(footprints.crs, footprints.bounds));
  const std::string& stated = of_raster ? rasters.crs : footprints.crs;
  const Bounds2& box = of_raster ? rasters.box : footprints.bounds;
  if (stated.empty() || box.empty()) return stated;
  std::string crs;
  if (is_projected(stated, box)) {
    crs = in_metres(stated);
    if (!is_metre(linear_unit_metres(stated)))
      warnings.push_back(
          {"crs_in_metres", 1,
           fmt::format("{} is in units of {:.10g} m; the city is in {}", crs_name(stated),
                       linear_unit_metres(stated), crs_name(crs))});
    return crs;
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
  // A domain that is fitted to the wind reaches beyond the buildings.
  constexpr double kBeyond = 2000;  // metres
  options.box = config.domain == "data" || box.empty() ? box : box.grown(kBeyond);
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
      input.points.push_back(p.x, p.y, z, kUnclassified);
      input.extent.extend(p);
    }
  input.points_read = static_cast<std::int64_t>(raster.values.size());
  input.points_kept = static_cast<std::int64_t>(input.points.size());
  input.points_by_class[kUnclassified] = input.points_kept;
  return input;
}

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

}  // namespace tetropolis
