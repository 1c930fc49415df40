#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/extract.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/terrain/dtm.h"

#include "city_account.h"
#include "city_warnings.h"
#include "clean_features.h"
#include "elevations.h"
#include "find_ground.h"
#include "run/read_input.h"
#include "run/result_files.h"
#include "stages.h"

namespace tetropolis {

namespace {

[[noreturn]] void throw_no_footprint(const Config& config, const CityModel& raw,
                                     const Report& report) {
  const std::string why =
      raw.dropped.empty() ? "the file has none"
                          : fmt::format("the first of {}: feature {}: {}", raw.dropped.size(),
                                        raw.dropped.front().source_id, raw.dropped.front().reason);
  throw Error(ErrorKind::kInput,
              fmt::format("{}: no usable footprint lies in the domain ({}, {}) - ({}, {}) ({}); "
                          "check --bounds, --domain-margin and the CRS, or add --terrain-only",
                          config.footprints, report.domain.xmin, report.domain.ymin,
                          report.domain.xmax, report.domain.ymax, why));
}

/// Mean of the members' attribute heights, weighted by area; NaN where none has one.
double merged_attribute_height(const CityModel& raw, const std::vector<BuildingIndex>& members) {
  double weight = 0, sum = 0;
  for (const BuildingIndex m : members) {
    const Building& member = raw.buildings[static_cast<std::size_t>(m)];
    if (!(member.attribute_height > 0)) continue;
    const double share = area(member.footprint);
    weight += share;
    sum += share * member.attribute_height;
  }
  return weight > 0 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
}

/// The simplified model without heights.
CityModel merged_model(const CityModel& raw, const Simplification& simple) {
  constexpr std::uint32_t inherited = kRepaired | kClipped;
  CityModel model;
  model.origin = raw.origin;
  model.domain = raw.domain;
  model.crs = raw.crs;
  model.dropped = raw.dropped;
  for (std::size_t i = 0; i < simple.footprints.size(); ++i) {
    Building building;
    building.id = fmt::format("b{}", i);
    building.footprint = simple.footprints[i];
    building.flags = simple.flags[i];
    for (const BuildingIndex m : simple.members[i]) {
      const Building& member = raw.buildings[static_cast<std::size_t>(m)];
      building.source_ids.insert(building.source_ids.end(), member.source_ids.begin(),
                                 member.source_ids.end());
      building.flags |= member.flags & inherited;
    }
    building.attribute_height = merged_attribute_height(raw, simple.members[i]);
    model.buildings.push_back(std::move(building));
  }
  for (const DroppedFootprint& dropped : simple.dropped)
    for (const std::string& id : raw.buildings[static_cast<std::size_t>(dropped.index)].source_ids)
      model.dropped.push_back({id, dropped.reason});
  return model;
}

std::vector<Polygon> footprints_of(const CityModel& model) {
  std::vector<Polygon> footprints;
  for (const Building& building : model.buildings) footprints.push_back(building.footprint);
  return footprints;
}

Simplification simplify(const Config& config, const CityModel& raw, const Progress& progress) {
  SimplifyOptions options;
  options.min_distance = config.min_building_distance;
  options.growths = config.merge_growths;
  options.min_area = config.min_building_area;
  options.parallel_tolerance = config.parallel_tolerance;
  Simplification simple = simplify_footprints(footprints_of(raw), raw.domain, options, progress);
  require_each_once(raw, simple);
  return simple;
}

std::map<std::string, std::int64_t> resorts_by_name(const SimplifyStats& stats) {
  std::map<std::string, std::int64_t> resorts{{"merged_by_union", stats.merged_by_union},
                                              {"merged_by_bridge", stats.merged_by_bridge},
                                              {"merged_by_hulls", stats.merged_by_hulls},
                                              {"merged_by_hull", stats.merged_by_hull},
                                              {"merged_late", stats.merged_late},
                                              {"vertices_dropped", stats.vertices_dropped},
                                              {"edges_merged", stats.edges_merged},
                                              {"edges_slid", stats.edges_slid},
                                              {"vertices_moved", stats.vertices_moved},
                                              {"holes_filled", stats.holes_filled},
                                              {"gaps_filled", stats.gaps_filled},
                                              {"arms_cut", stats.arms_cut},
                                              {"necks_widened", stats.necks_widened},
                                              {"corners_blunted", stats.corners_blunted},
                                              {"local_hulls", stats.local_hulls},
                                              {"hull_repairs", stats.hull_repairs},
                                              {"clipped", stats.clipped}};
  for (std::size_t k = 1; k < stats.merged_by_patch.size(); ++k)
    resorts[fmt::format("merged_by_patch_{}", k)] = stats.merged_by_patch[k];
  return resorts;
}

void fill_city_report(const CityModel& raw, const CityModel& city, const Simplification& simple,
                      Report& report) {
  CityReport& out = *report.city;
  out.raw_buildings = static_cast<std::int64_t>(raw.buildings.size());
  out.buildings = static_cast<std::int64_t>(city.buildings.size());
  out.min_clearance = simple.stats.min_clearance;
  out.area_before = simple.stats.area_before;
  out.area_after = simple.stats.area_after;
  out.area_moved = simple.stats.area_changed;
  if (out.area_before > 0) out.area_changed_share = out.area_moved / out.area_before;
  out.max_distance = simple.stats.max_distance;
  out.hulls = simple.stats.hulls;
  out.resorts = resorts_by_name(simple.stats);
  out.dropped = city.dropped;
  for (const Building& building : city.buildings) {
    if (building.source_ids.size() > 1) ++out.merged_groups;
    for (const std::string& name : flag_names(building.flags)) ++out.flags[name];
  }
}

/// The first file with a ground point that lies at no elevation, as a header that is off or rotten
/// bytes make them.
std::string file_off_earth(const InputData& input) {
  const PointCloud& cloud = input.points;
  for (const PointFile& file : input.files)
    for (std::size_t p = file.points.kept.begin; p < file.points.kept.end; ++p)
      if (is_ground(cloud.classification[p]) && !is_elevation(cloud.z[p])) return file.path;
  return {};
}

void require_elevations(const Raster& dtm, const Config& config, const InputData& input) {
  const auto wrong = find_no_elevation(dtm.values);
  if (wrong == dtm.values.end()) return;
  const std::string file = file_off_earth(input);
  throw Error(ErrorKind::kInput,
              fmt::format("{}: ground points lie at elevations such as {:.6g} m; get the file "
                          "again, or check scale and offset of z in its header ('tetropolis info')",
                          file.empty() ? points_given(config) : file, *wrong));
}

Raster make_terrain(const Config& config, const InputData& input, StepClock& clock,
                    Report& report) {
  DtmReport dtm_report;
  DtmOptions options;
  options.step = config.dtm_step;
  Raster dtm = clock.run("1.3", "terrain", [&](const Progress& progress) {
    return build_dtm(input.points, input.domain, options, progress, &dtm_report);
  });
  require_elevations(dtm, config, input);
  report.city->dtm_empty_share = dtm_report.empty_share;
  report.city->dtm_void_share = dtm_report.void_share;
  warn_of_terrain(dtm_report, report);
  return dtm;
}

/// What is known before anything is written.
struct Prepared {
  InputData input;
  CityModel raw;  ///< Without heights.
  Raster dtm;
  std::vector<Polygon> crossing;  ///< CleanFeatures::crossing.
};

/// Steps 1.1 to 1.4. Points that are misread lead to errors of any kind, and all of them say so.
Prepared prepare(const Config& config, Next next, StepClock& clock, Report& report) {
  Prepared result;
  std::string misread;
  try {
    InputData& input = result.input = read_input(config, next, clock, report, misread);
    find_ground(config, input, clock, report);
    CityModel& raw = result.raw;
    raw.origin = input.origin;
    raw.domain = input.domain;
    raw.crs = input.crs;
    report.city.emplace();
    result.dtm = make_terrain(config, input, clock, report);
    CleanFeatures clean = clock.run("1.4", "clean footprints", [&](const Progress& progress) {
      return clean_features(config, input.footprints, raw.domain, report, progress);
    });
    report.input->footprint_parts += clean.parts;
    raw.buildings = std::move(clean.buildings);
    raw.dropped = std::move(clean.dropped);
    result.crossing = std::move(clean.crossing);
    if (raw.buildings.empty() && !config.terrain_only) throw_no_footprint(config, raw, report);
  } catch (const Error& error) {
    const std::string message = error.what();
    if (misread.empty() || message.find(misread) != std::string::npos) throw;
    throw Error(error.kind(), message + "; " + misread);
  }
  return result;
}

}  // namespace

CityAndTerrain make_city(const Config& config, Next next, OutputFolder& out, StepClock& clock,
                         Report& report) {
  Prepared prepared = prepare(config, next, clock, report);
  const PointCloud& cloud = prepared.input.points;
  CityModel& raw = prepared.raw;
  Raster& dtm = prepared.dtm;
  warn_of_giants(raw, report);

  const HeightOptions heights{config.ground_percentile, config.roof_percentile,
                              config.min_building_height};
  const BuildingPoints points = clock.run("1.5", "extract points", [&](const Progress& progress) {
    ExtractOptions options;
    options.margin = config.ground_margin;
    options.sigma = config.outlier_sigma;
    options.no_buildings = prepared.input.no_buildings;
    return extract_building_points(raw.buildings, prepared.crossing, cloud, options, progress);
  });
  clock.run("1.6", "building heights",
            [&](const Progress&) { compute_heights(raw.buildings, points, cloud, dtm, heights); });
  warn_of_missing_roofs(raw, report);
  clock.run("1.7", "write city model", [&](const Progress&) {
    write_raster(out.result(results::kTerrain), dtm, raw.origin, raw.crs, raw.domain.bounds());
    write_city(out.result(results::kRawCity), raw, "City model before simplification");
  });

  const Simplification simple = clock.run("2.1", "merge footprints", [&](const Progress& progress) {
    return simplify(config, raw, progress);
  });
  CityModel city = clock.run("2.2", "clean merged footprints", [&](const Progress&) {
    CityModel model = merged_model(raw, simple);
    require_all_accounted(prepared.input.footprints, model);
    return model;
  });
  if (city.buildings.empty() && !config.terrain_only)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: all {} buildings were dropped (the last, feature {}: {}); lower "
                            "--min-building-area or --min-building-distance, or add --terrain-only",
                            config.footprints, raw.buildings.size(), city.dropped.back().source_id,
                            city.dropped.back().reason));
  warn_of_lost_area(raw, simple, report);
  clock.run("2.3", "heights of merged buildings", [&](const Progress&) {
    compute_heights(city.buildings, merge_building_points(points, simple.members), cloud, dtm,
                    heights);
  });
  warn_of_exclusion(points, report);
  clock.run("2.4", "write merged city model", [&](const Progress&) {
    write_city(out.result(results::kCity), city, "City model after simplification");
  });
  fill_city_report(raw, city, simple, report);
  return {std::move(city), std::move(dtm)};
}

}  // namespace tetropolis
