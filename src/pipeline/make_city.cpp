#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/clean.h"
#include "tetropolis/city/clip.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/city/simplify.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson.h"
#include "tetropolis/io/geotiff.h"
#include "tetropolis/terrain/dtm.h"

#include "elevations.h"
#include "find_ground.h"
#include "read_input.h"
#include "result_files.h"
#include "stages.h"

namespace tetropolis {

namespace {

/// Share of empty nodes above which a terrain is more guess than data.
constexpr double kMostlyEmpty = 0.75;

/// Share of squares of 20 m without a ground point above which something is missing: more than
/// blocks of buildings and waters take up in a city.
constexpr double kManyVoids = 0.35;

/// Square metres of parts given up that are more than the slivers of a repair.
constexpr double kNoSliver = 1;

/// Share of buildings without roof points from which on it is not the buildings that are odd.
constexpr double kManyRoofless = 0.1;

/// Ids for the parts that the domain cuts features into, beyond the first: those that follow the
/// parts that a multipolygon has.
class PartIds {
 public:
  explicit PartIds(const FootprintsInput& input) {
    for (const Footprint& feature : input.features) taken_.insert(feature.source_id);
    for (const Dropped& feature : input.dropped) taken_.insert(feature.source_id);
  }
  std::string next(const std::string& source_id) {
    const std::size_t mark = source_id.rfind('#');
    const std::string whole = source_id.substr(0, mark);
    const std::string& base = taken_.contains(whole) ? whole : source_id;
    int& k = last_.try_emplace(base, 1).first->second;
    for (;;)
      if (std::string id = fmt::format("{}#{}", base, ++k); taken_.insert(id).second) return id;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;
};

/// Counts a feature of which parts have been given up, and names the first.
void count_lost_parts(const std::string& source_id, double lost_area, Warning& warning) {
  if (!(lost_area > kNoSliver) || warning.count++ > 0) return;
  warning.message = fmt::format(
      "where a footprint falls into parts as its rings are repaired, only the largest is kept, and "
      "where the domain cuts it, only those of --min-building-area; the first is feature {}, which "
      "loses parts of {:.0f} m2",
      source_id, lost_area);
}

/// Step 1.4. Fills model.buildings and model.dropped; every feature ends in one of them. Returns
/// what the footprints that are dropped for crossing the domain boundary have inside.
std::vector<Polygon> clean_features(const Config& config, const FootprintsInput& input,
                                    CityModel& model, Report& report, const Progress& progress) {
  model.dropped = input.dropped;
  const std::size_t size = input.features.size();
  std::vector<CleanedFootprint> clean(size);
  SharedProgress shared(progress, static_cast<std::int64_t>(size));
  parallel_chunks(size, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Polygon& polygon = input.features[i].polygon;
      if (position_in_domain(polygon, model.domain) != DomainPosition::kOutside)
        clean[i] = clean_footprint(polygon, {config.parallel_tolerance});
    }
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  std::vector<Polygon> crossing;
  Warning lost_parts{"parts_lost", 0, {}};
  PartIds part_ids(input);
  for (std::size_t i = 0; i < size; ++i) {
    const Footprint& feature = input.features[i];
    const auto drop = [&](const std::string& reason) {
      model.dropped.push_back({feature.source_id, reason});
    };
    const auto position_of = [&](const Polygon& polygon) {
      return position_in_domain(polygon, model.domain);
    };
    CleanedFootprint& cleaned = clean[i];
    const bool outside = position_of(feature.polygon) == DomainPosition::kOutside;
    if (!outside && !cleaned.usable()) {
      drop(cleaned.reason);
      continue;
    }
    // Of what is left: a spike without width may have reached across the boundary.
    const DomainPosition position =
        outside ? DomainPosition::kOutside : position_of(cleaned.polygon);
    if (position == DomainPosition::kOutside) {
      drop("outside the domain");
      continue;
    }
    std::uint32_t flags = cleaned.repaired ? kRepaired : 0U;
    std::vector<Polygon> parts;
    if (position == DomainPosition::kInside) {
      parts.push_back(std::move(cleaned.polygon));
    } else if (config.boundary_buildings == BoundaryBuildings::kDrop) {
      drop("crosses the domain boundary");
      for (Polygon& part : parts_in_box(cleaned.polygon, model.domain))
        crossing.push_back(std::move(part));
      continue;
    } else {
      // Cut back by the merge distance, so that the strip left is wide enough to mesh.
      double cut_off = 0;
      parts = clip_to_box(cleaned.polygon,
                          model.domain.grown(-config.min_building_distance - kCoordinateStep * 4),
                          config.min_building_area, &cut_off);
      cleaned.lost_area += cut_off;
      if (parts.empty()) {
        drop("crosses the domain boundary, with nothing left inside");
        continue;
      }
      flags |= kClipped;
    }
    count_lost_parts(feature.source_id, cleaned.lost_area, lost_parts);
    report.input->footprint_parts += static_cast<std::int64_t>(parts.size()) - 1;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      Building building;
      building.flags = flags;
      building.id = fmt::format("b{}", model.buildings.size());
      building.source_ids = {k == 0 ? feature.source_id : part_ids.next(feature.source_id)};
      building.footprint = std::move(parts[k]);
      building.attribute_height = feature.height;
      model.buildings.push_back(std::move(building));
    }
  }
  if (lost_parts.count > 0) report.warnings.push_back(lost_parts);
  return crossing;
}

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

/// A polygon that covers most of the domain is hardly a building, and swallows those in it.
void warn_of_giants(const CityModel& raw, Report& report) {
  constexpr double kMost = 0.5;
  const double domain = raw.domain.width() * raw.domain.height();
  Warning warning{"building_covers_domain", 0, {}};
  for (const Building& building : raw.buildings) {
    const double share = area(building.footprint) / domain;
    if (share <= kMost) continue;
    if (warning.count++ == 0)
      warning.message = fmt::format(
          "feature {} covers {:.0f} % of the domain and absorbs every building there; remove it if "
          "it is not a building",
          building.source_ids.front(), 100 * share);
  }
  if (warning.count > 0) report.warnings.push_back(warning);
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

/// Guarantee 1: every polygon of the input is in one building or in `dropped`, and nothing is there
/// twice.
void check_account(const FootprintsInput& input, const CityModel& model) {
  std::set<std::string_view> accounted;
  const auto account = [&](const std::string& id) {
    if (!accounted.insert(id).second)
      throw Error(ErrorKind::kGuarantee, fmt::format("feature {} is accounted for twice", id));
  };
  for (const Dropped& dropped : model.dropped) account(dropped.source_id);
  for (const Building& building : model.buildings)
    for (const std::string& id : building.source_ids) account(id);
  const auto require = [&](const auto& features) {
    for (const auto& feature : features)
      if (!accounted.contains(feature.source_id))
        throw Error(ErrorKind::kGuarantee,
                    fmt::format("feature {} is not accounted for", feature.source_id));
  };
  require(input.features);
  require(input.dropped);
}

void warn_of_missing_roofs(const CityModel& raw, Report& report) {
  const auto roofless =
      std::count_if(raw.buildings.begin(), raw.buildings.end(),
                    [](const Building& building) { return (building.flags & kNoRoofPoints) != 0; });
  const auto all = static_cast<double>(raw.buildings.size());
  if (static_cast<double>(roofless) <= kManyRoofless * all) return;
  report.warnings.push_back(
      {"no_roof_points", roofless,
       fmt::format("{} of {} buildings have no roof points and get the minimum height; is part of "
                   "the cloud not classified, or missing?",
                   roofless, raw.buildings.size())});
}

/// Footprints of which little is as wide as the distance that they have to keep.
void warn_of_lost_area(const CityModel& raw, const Simplification& simple, Report& report) {
  Warning warning{"footprint_mostly_lost", 0, {}};
  for (std::size_t i = 0; i < simple.footprints.size(); ++i) {
    const double left = area(simple.footprints[i]);
    const double changed = simple.changes[i].area;
    if (changed <= left) continue;  // what was filled is part of what is left
    if (warning.count++ > 0) continue;
    const auto first = static_cast<std::size_t>(simple.members[i].front());
    warning.message = fmt::format(
        "footprints lost more than half of their area where they are narrower than "
        "--min-building-distance; the first is feature {}, of which {:.0f} m2 are left ({:.0f} m2 "
        "changed)",
        raw.buildings[first].source_ids.front(), left, changed);
  }
  if (warning.count > 0) report.warnings.push_back(warning);
}

/// Guarantee 1 again: simplification has put every building into one, or dropped it.
void require_each_once(const CityModel& raw, const Simplification& simple) {
  std::vector<int> times(raw.buildings.size(), 0);
  for (const std::vector<BuildingIndex>& members : simple.members)
    for (const BuildingIndex m : members) ++times[static_cast<std::size_t>(m)];
  for (const DroppedFootprint& dropped : simple.dropped)
    ++times[static_cast<std::size_t>(dropped.index)];
  for (std::size_t i = 0; i < times.size(); ++i)
    if (times[i] != 1)
      throw Error(ErrorKind::kGuarantee,
                  fmt::format("feature {} is accounted for {} times after merging; report it",
                              raw.buildings[i].source_ids.front(), times[i]));
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

void warn_of_exclusion(const BuildingPoints& points, Report& report) {
  const std::vector<std::uint8_t>& marks = points.by_exclusion;
  const auto count = std::count(marks.begin(), marks.end(), 1);
  if (count == 0) return;
  const bool everywhere = count == std::ssize(marks);
  const char* const taken =
      "roof points are those inside footprints that are neither ground, water, vegetation nor "
      "noise";
  if (everywhere)
    report.warnings.push_back(
        {"no_building_class", report.input->points_kept,
         fmt::format("the cloud has no class 6 (building), or stray points of it; {}", taken)});
  else
    report.warnings.push_back(
        {"building_class_partly", count,
         fmt::format("buildings are in files without class 6 (building); their {}", taken)});
}

void warn_of_terrain(const DtmReport& dtm, Report& report) {
  const char* const advice =
      report.input->ground_filtered > 0
          ? "raise --ground-filter-slope or lower --ground-filter-window if the filter took "
            "terrain "
            "for objects"
          : "use --ground-filter always if part of the cloud is not classified";
  if (dtm.empty_share > kMostlyEmpty)
    report.warnings.push_back(
        {"terrain_mostly_filled",
         static_cast<std::int64_t>(dtm.empty_share * static_cast<double>(dtm.nodes)),
         fmt::format(
             "{:.0f} % of the terrain's nodes have no ground point nearby; they were filled from "
             "their neighbours; check --bounds, raise --dtm-step, or {}",
             100 * dtm.empty_share, advice)});
  else if (dtm.void_share > kManyVoids)
    report.warnings.push_back(
        {"terrain_voids", dtm.voids,
         fmt::format(
             "{:.0f} % of the domain's squares of 20 m have no ground point; the terrain there is "
             "filled from around; check --bounds, or {}",
             100 * dtm.void_share, advice)});
}

/// A header that is off shows here, or bytes that have rotted; then points outside of their box
/// name the file.
void require_elevations(const Raster& dtm, const Config& config, const Report& report) {
  const auto wrong = find_no_elevation(dtm.values);
  if (wrong == dtm.values.end()) return;
  const auto outside =
      std::find_if(report.warnings.begin(), report.warnings.end(),
                   [](const Warning& warning) { return warning.code == "las_points_outside_box"; });
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: ground points lie at elevations such as {:.6g} m; get the file again, "
                  "or check scale and offset of z in its header ('tetropolis info')",
                  outside == report.warnings.end() ? config.points.front() : outside->message,
                  *wrong));
}

Raster make_terrain(const Config& config, const InputData& input, StepClock& clock,
                    Report& report) {
  DtmReport dtm_report;
  DtmOptions options;
  options.step = config.dtm_step;
  Raster dtm = clock.run("1.3", "terrain", [&](const Progress& progress) {
    return build_dtm(input.points, input.domain, options, progress, &dtm_report);
  });
  require_elevations(dtm, config, report);
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
  std::vector<Polygon> crossing;  ///< As clean_features returns it.
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
    result.crossing = clock.run("1.4", "clean footprints", [&](const Progress& progress) {
      return clean_features(config, input.footprints, raw, report, progress);
    });
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
    write_raster(out.result(results::kTerrain), dtm, raw.origin, raw.crs, raw.domain);
    write_city(out.result(results::kRawCity), raw, "City model before simplification");
  });

  const Simplification simple = clock.run("2.1", "merge footprints", [&](const Progress& progress) {
    return simplify(config, raw, progress);
  });
  CityModel city = clock.run("2.2", "clean merged footprints", [&](const Progress&) {
    CityModel model = merged_model(raw, simple);
    check_account(prepared.input.footprints, model);
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
