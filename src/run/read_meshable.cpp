#include "read_meshable.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/heights.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/pipeline/meshable.h"

#include "mistaken_input.h"
#include "pipeline/elevations.h"
#include "pipeline/require_metres.h"
#include "pipeline/require_room.h"
#include "pipeline/require_terrain.h"

namespace tetropolis {

namespace {

const std::string& terrain_path(const Config& config) { return config.dtm.front(); }

/// The domain of a written city model and terrain, local frame, and what it comes from: as given,
/// as the model says, as the terrain's file says, or all of the terrain.
std::pair<Domain, std::string> domain_of(const Config& config, const CityModel& city,
                                         const RasterInput& terrain) {
  if (!config.bounds.empty())
    return {Bounds2{snap_coordinate(config.bounds[0] - city.origin.x),
                    snap_coordinate(config.bounds[1] - city.origin.y),
                    snap_coordinate(config.bounds[2] - city.origin.x),
                    snap_coordinate(config.bounds[3] - city.origin.y)},
            "`bounds`"};
  if (!city.domain.empty() && city.domain.bounds().width() > 0) return {city.domain, config.city};
  return {terrain.domain.value_or(terrain.raster.bounds()), terrain_path(config)};
}

void require_one_system(const Config& config, const CityModel& city, const RasterInput& terrain) {
  if (city.crs.empty() || terrain.crs.empty() || same_horizontal_crs(city.crs, terrain.crs)) return;
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: the terrain is in {}, the city {} in {}; give the one that was "
                  "made with the city, or reproject one of them",
                  terrain_path(config), crs_name(terrain.crs), config.city, crs_name(city.crs)));
}

/// Warns where the terrain is not what the buildings stand on: heights of two vertical systems are
/// tens of metres apart. What the terrain rises and falls by under a building is no difference.
void warn_off_terrain(const Config& config, const CityModel& city, const Raster& terrain,
                      std::vector<Warning>& warnings) {
  constexpr double kMostOff = 3;  // metres, of the median
  if (city.buildings.empty()) return;
  std::vector<double> above;
  for (const Building& building : city.buildings) {
    double low = sample(terrain, interior_point(building.footprint)), high = low;
    for (const Point2 p : building.footprint.outer) {
      const double z = sample(terrain, p);
      low = std::min(low, z);
      high = std::max(high, z);
    }
    above.push_back(building.h_ground - std::clamp(building.h_ground, low, high));
  }
  const auto off = std::count_if(above.begin(), above.end(),
                                 [](double height) { return std::abs(height) > kMostOff; });
  const double median = percentile(above, 50);
  if (std::abs(median) <= kMostOff) return;
  warnings.push_back(
      {"city_off_terrain", off,
       fmt::format(
           "{}: most buildings stand {:.1f} m {} this terrain (median of h_ground); are its "
           "heights of another vertical system than those of {}, or is it of another place?",
           terrain_path(config), std::abs(median), median > 0 ? "above" : "below", config.city)});
}

void require_elevations(const Config& config, const RasterInput& terrain) {
  const std::vector<double>& values = terrain.raster.values;
  const auto wrong = find_no_elevation(values);
  if (wrong == values.end()) return;
  const auto nx = static_cast<std::ptrdiff_t>(terrain.raster.nx);
  const std::ptrdiff_t node = wrong - values.begin();
  throw Error(ErrorKind::kInput,
              fmt::format("{}: {} in column {}, row {} is not an elevation; if it stands for a "
                          "missing value, declare it (gdal_edit.py -a_nodata {} {})",
                          terrain_path(config), *wrong, node % nx,
                          terrain.raster.ny - 1 - node / nx, *wrong, terrain_path(config)));
}

/// Of a model that comes from elsewhere, or for another domain.
void leave_out_unmeshable(const Config& config, CityModel& city, std::vector<Warning>& warnings) {
  const std::size_t before = city.dropped.size();
  const std::size_t left_out = drop_unmeshable(city, config.min_building_distance);
  if (left_out == 0) return;
  const Dropped& first = city.dropped[before];
  warnings.push_back(
      {"city_buildings_left_out", static_cast<std::int64_t>(left_out),
       fmt::format("{}: {} features are left out, the first, {}: {}; the domain is {}", config.city,
                   left_out, first.source_id, first.reason, domain_text(city))});
}

/// What a mesh cannot have as it is gets simpler roofs, or becomes a block.
void flatten_parts(const Config& config, CityModel& city, std::vector<Warning>& warnings) {
  const FlattenedRoofs flattened = flatten_unmeshable(city, config.min_building_distance);
  if (flattened.simplified > 0)
    warnings.push_back(
        {"city_parts_simplified", static_cast<std::int64_t>(flattened.simplified),
         fmt::format("{}: the roofs of {} buildings get simpler lines, which leave room for cells "
                     "(first: {})",
                     config.city, flattened.simplified, flattened.first_simplified)});
  if (flattened.count == 0) return;
  warnings.push_back(
      {"city_parts_flattened", static_cast<std::int64_t>(flattened.count),
       fmt::format("{}: {} buildings become blocks at h_roof, as their roofs leave no room for "
                   "cells (first: {})",
                   config.city, flattened.count, flattened.first)});
}

/// An empty city needs to be asked for.
void require_buildings(const Config& config, const CityModel& city) {
  if (!city.buildings.empty() || config.terrain_only) return;
  const std::string why =
      city.dropped.empty()
          ? ""
          : fmt::format(" ({} dropped, the first, {}: {})", city.dropped.size(),
                        city.dropped.front().source_id, city.dropped.front().reason);
  throw Error(ErrorKind::kInput, config.city + ": holds no building" + why +
                                     "; add terrain_only for a mesh of the terrain");
}

}  // namespace

MeshableInput read_meshable(const Config& config, std::vector<Warning>& warnings) {
  MeshableInput input;
  CityModel& city = input.city = read_city(config.city, &warnings, BrokenObjects::kDrop);
  require_metres(city.crs, config.city);
  RasterInput terrain = read_raster(terrain_path(config), city.origin);
  warnings.insert(warnings.end(), terrain.warnings.begin(), terrain.warnings.end());
  require_metres(terrain.crs, terrain_path(config));
  require_heights_in_metres(terrain.height_unit, terrain_path(config), nullptr);
  require_elevations(config, terrain);
  refuse_degree_bounds(config, city.crs.empty() ? terrain.crs : city.crs,
                       terrain.raster.bounds().moved(city.origin));
  std::string source;
  std::tie(city.domain, source) = domain_of(config, city, terrain);
  require_room(config.min_building_distance, city.domain.bounds(), source);
  require_one_system(config, city, terrain);
  require_terrain_under(city, terrain.raster, terrain_path(config));
  if (city.crs.empty()) city.crs = terrain.crs;
  if (source != config.city) {
    city.domain_top = std::numeric_limits<double>::quiet_NaN();
    leave_out_unmeshable(config, city, warnings);
  }
  require_buildings(config, city);
  flatten_parts(config, city, warnings);
  CityFacts& facts = input.facts;
  facts.min_clearance = require_meshable(city, config.min_building_distance, config.city);
  warn_off_terrain(config, city, terrain.raster, warnings);
  facts.raw_buildings = facts.buildings = static_cast<std::int64_t>(city.buildings.size());
  for (const Building& building : city.buildings)
    facts.merged_groups += building.source_ids.size() > 1 ? 1 : 0;
  facts.dropped = city.dropped;
  input.terrain = std::move(terrain.raster);
  return input;
}

}  // namespace tetropolis
