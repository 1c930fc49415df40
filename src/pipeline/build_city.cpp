#include "tetropolis/pipeline/build_city.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/city/roof_summary.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/dtm.h"

#include "canopy_heights.h"
#include "city_account.h"
#include "city_input.h"
#include "city_warnings.h"
#include "clean_features.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "elevations.h"
#include "find_ground.h"
#include "measured_ground.h"
#include "memory.h"
#include "planned.h"
#include "stated_elevations.h"

namespace tetropolis {

namespace {

[[noreturn]] void throw_no_footprint(const CityModel& raw, const std::string& source) {
  const std::string why =
      raw.dropped.empty() ? "the file has none"
                          : fmt::format("the first of {}: feature {}: {}", raw.dropped.size(),
                                        raw.dropped.front().source_id, raw.dropped.front().reason);
  const Bounds2 domain = raw.domain.moved(raw.origin).bounds();
  throw Error(ErrorKind::kInput,
              fmt::format("{}: no usable footprint lies in the domain ({}, {}) - ({}, {}) ({}); "
                          "check `bounds`, domain_margin and the CRS, or add terrain_only",
                          source, domain.xmin, domain.ymin, domain.xmax, domain.ymax, why));
}

/// Of each building: which flag tells what a height rests on that is not measured.
using HeightBasis = std::vector<std::uint32_t>;

/// Mean of the members' attribute heights, weighted by area, or of their roofs' elevations where
/// one states that; NaN where none has one. Returns on what they rest. `raw` has heights.
std::uint32_t merge_attribute_heights(const CityModel& raw, const HeightBasis& basis,
                                      const std::vector<BuildingIndex>& members, Building& merged) {
  double weight = 0, sum = 0, roofs = 0;
  std::uint32_t merged_basis = 0;
  bool are_elevations = false;
  for (const BuildingIndex m : members) {
    const Building& member = raw.buildings[m];
    if (!(member.attribute_height > 0)) continue;
    const double share = area(member.footprint);
    weight += share;
    sum += share * member.attribute_height;
    roofs += share * (member.h_ground + member.attribute_height);
    are_elevations = are_elevations || std::isfinite(member.attribute_roof);
    merged_basis |= basis[m];
  }
  if (are_elevations) merged.attribute_roof = roofs / weight;
  merged.attribute_height =
      snap_height(weight > 0 ? sum / weight : std::numeric_limits<double>::quiet_NaN());
  return merged_basis;
}

/// Where a height was stated, tells on what it rests.
void tell_basis(const HeightBasis& basis, CityModel& model) {
  for (std::size_t b = 0; b < basis.size(); ++b) {
    std::uint32_t& flags = model.buildings[BuildingIndex(b)].flags;
    if ((flags & kRoofFromAttribute) != 0) flags = (flags & ~kRoofFromAttribute) | basis[b];
  }
}

/// The simplified model without heights.
CityModel merged_model(const CityModel& raw, const Simplification& simple,
                       const HeightBasis& raw_basis, HeightBasis& basis) {
  constexpr std::uint32_t inherited = kRepaired | kClipped | kPlanned;
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
      const Building& member = raw.buildings[m];
      building.source_ids.insert(building.source_ids.end(), member.source_ids.begin(),
                                 member.source_ids.end());
      building.flags |= member.flags & inherited;
    }
    basis.push_back(merge_attribute_heights(raw, raw_basis, simple.members[i], building));
    model.buildings.push_back(std::move(building));
  }
  for (const DroppedFootprint& dropped : simple.dropped)
    for (const std::string& id : raw.buildings[dropped.index].source_ids)
      model.dropped.push_back({id, dropped.reason, dropped.cause});
  return model;
}

std::vector<Polygon> footprints_of(const CityModel& model) {
  std::vector<Polygon> footprints;
  for (const Building& building : model.buildings) footprints.push_back(building.footprint);
  return footprints;
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
                                              {"dead_ends_closed", stats.dead_ends_closed},
                                              {"arms_cut", stats.arms_cut},
                                              {"necks_widened", stats.necks_widened},
                                              {"corners_blunted", stats.corners_chamfered},
                                              {"local_hulls", stats.local_hulls},
                                              {"hull_repairs", stats.hull_repairs},
                                              {"clipped", stats.clipped}};
  for (std::size_t k = 1; k < stats.merged_by_gap_fill.size(); ++k)
    resorts[fmt::format("merged_by_patch_{}", k)] = stats.merged_by_gap_fill[k];
  return resorts;
}

void fill_facts(const CityModel& raw, const CityModel& city, const Simplification& simple,
                CityFacts& facts) {
  facts.raw_buildings = static_cast<std::int64_t>(raw.buildings.size());
  facts.buildings = static_cast<std::int64_t>(city.buildings.size());
  facts.min_clearance = simple.stats.min_clearance;
  facts.area_before = simple.stats.area_before;
  facts.area_after = simple.stats.area_after;
  if (facts.roofs.parts > 0 || facts.domain.length > 0) {
    // Vertices of parts bend outlines by a tenth of a millimetre; a domain may leave buildings out.
    const std::vector<Polygon> footprints = footprints_of(city);
    facts.area_after = total_area(footprints);
    facts.min_clearance = joint_clearance(footprints, city.domain).distance;
  }
  for (const Building& building : raw.buildings) facts.volume_before += volume_of(building);
  for (const Building& building : city.buildings) facts.volume_after += volume_of(building);
  facts.area_moved = simple.stats.symmetric_difference;
  if (facts.area_before > 0) facts.area_changed_share = facts.area_moved / facts.area_before;
  facts.max_distance = simple.stats.max_hausdorff_distance;
  facts.hulls = simple.stats.hulls;
  facts.resorts = resorts_by_name(simple.stats);
  facts.dropped = city.dropped;
  for (const Building& building : city.buildings) {
    if (building.source_ids.size() > 1) ++facts.merged_groups;
    for (const std::string& name : flag_names(building.flags)) ++facts.flags[name];
  }
}

/// What was read: the points, and the footprints before the domain cuts them.
InputFacts facts_of(const CitySources& sources) {
  const PointsInput& points = sources.points;
  const FootprintsInput& footprints = sources.footprints;
  InputFacts facts;
  if (sources.terrain)
    facts.ground = sources.terrain->raster.values.size() == 1 ? "level"
                   : sources.terrain->is_of_bases             ? "bases"
                                                              : "raster";
  else if (sources.has_surface)
    facts.ground = "raster";
  if (sources.has_surface)
    facts.roofs = "raster";
  else if (points.points.size() == 0)
    facts.roofs = "attributes";
  facts.point_files = static_cast<std::int64_t>(points.files.size());
  facts.point_files_skipped = points.files_skipped;
  facts.points_read = points.points_read;
  facts.points_kept = points.points_kept;
  facts.points_by_class = points.points_by_class;
  facts.footprints_unlisted = footprints.unlisted;
  facts.footprint_parts =
      std::ssize(footprints.features) + std::ssize(footprints.dropped) + footprints.unlisted;
  // A caller that has made the footprints of arrays need not count them.
  facts.footprints_read =
      footprints.features_read > 0 ? footprints.features_read : facts.footprint_parts;
  return facts;
}

/// The first file with a ground point that lies at no elevation, as a header that is off or rotten
/// bytes make them.
std::string file_off_earth(const PointsInput& points) {
  const PointCloud& cloud = points.points;
  for (const FilePoints& file : points.files)
    for (std::size_t p = file.kept.begin; p < file.kept.end; ++p)
      if (is_ground(cloud.classification[p]) && !is_elevation(cloud.z[p])) return file.path;
  return {};
}

void require_elevations(const Raster& dtm, const PointsInput& points) {
  const auto wrong = find_no_elevation(dtm.values);
  if (wrong == dtm.values.end()) return;
  const std::string file = file_off_earth(points);
  throw Error(ErrorKind::kInput,
              fmt::format("{}: ground points lie at elevations such as {:.6g} m; get the file "
                          "again, or check scale and offset of z in its header ('tetropolis info')",
                          file.empty() ? points.source : file, *wrong));
}

/// The nodes of step 1.3 with the heights of a terrain that is known.
Raster sampled_terrain(const BuildCityOptions& options, const CityInput& input) {
  Raster dtm =
      dtm_grid(input.domain, options.dtm.step, options.origin ? Point2{0, 0} : options.dtm.anchor);
  parallel_chunks(static_cast<std::size_t>(dtm.ny), 16, [&](std::size_t begin, std::size_t end) {
    for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j)
      for (std::int32_t i = 0; i < dtm.nx; ++i)
        dtm.values[row_major(i, j, dtm.nx)] =
            sample(input.terrain->raster, {dtm.x0 + i * dtm.step, dtm.y0 + j * dtm.step});
  });
  return dtm;
}

Raster make_terrain(const BuildCityOptions& options, const CityInput& input, StepClock& clock,
                    BuiltCity& result) {
  if (input.terrain)
    return clock.run("1.3", "terrain", [&](const Progress&) {
      Raster given = sampled_terrain(options, input);
      round_to_single(given);
      warn_off_terrain(input, given, result.warnings);
      return given;
    });
  DtmReport dtm_report;
  Raster dtm = clock.run("1.3", "terrain", [&](const Progress& progress) {
    DtmOptions dtm_options = options.dtm;
    // So that the nodes of two domains are the same places.
    if (options.origin) dtm_options.anchor = Point2{0, 0};
    Raster made = build_dtm(input.points.points, input.domain, dtm_options, progress, &dtm_report);
    round_to_single(made);
    return made;
  });
  require_elevations(dtm, input.points);
  result.facts.dtm_empty_share = dtm_report.empty_share;
  result.facts.dtm_void_share = dtm_report.void_share;
  warn_of_terrain(dtm_report, result.input.ground_filtered > 0, result.warnings);
  return dtm;
}

/// Refuses points and terrain that will not fit into memory, now that they are counted.
void require_fits(const BuildCityOptions& options, const CityInput& input) {
  const double nodes =
      input.domain.width() * input.domain.height() / (options.dtm.step * options.dtm.step);
  require_points_fit(
      {static_cast<double>(input.points.points.size()), nodes, options.extract.margin},
      memory_limit(options.max_bytes));
}

PointLists no_points_of(std::size_t buildings) {
  PointLists lists;
  for (std::size_t b = 0; b < buildings; ++b) lists.push_back({});
  return lists;
}

/// Points inside planned buildings are of what stands there now.
void forget_roofs_of_planned(const CityModel& raw, BuildingPoints& points) {
  if (std::none_of(raw.buildings.begin(), raw.buildings.end(), is_planned)) return;
  PointLists lists;
  for (std::size_t b = 0; b < points.roof.size(); ++b) {
    const bool stands = !is_planned(raw.buildings[BuildingIndex(b)]);
    lists.push_back(stands ? points.roof[b] : std::span<const PointIndex>());
  }
  points.roof = std::move(lists);
}

/// The block that a planned building is merged into has the mean height of its members, weighted by
/// area, as no points tell of the planned one.
void set_heights_of_planned(const CityModel& raw,
                            std::span<const std::vector<BuildingIndex>> members, CityModel& city) {
  for (std::size_t b = 0; b < members.size(); ++b) {
    Building& building = city.buildings[BuildingIndex(b)];
    if (!is_planned(building) || building.n_roof_points == 0) continue;
    double volume = 0, whole = 0;
    for (const BuildingIndex m : members[b]) {
      volume += area(raw.buildings[m].footprint) * raw.buildings[m].h_roof;
      whole += area(raw.buildings[m].footprint);
    }
    building.h_roof = snap_height(volume / whole);
  }
}

/// Of points that were extracted for roofs, those that heights are computed from.
BuildingPoints without_outliers(const BuildCityOptions& options, BuildingPoints points,
                                const PointCloud& cloud) {
  if (options.lod != Lod::kBlock) {
    drop_outliers(points.roof, cloud, options.extract.sigma);
    drop_outliers(points.ground, cloud, options.extract.sigma);
  }
  return points;
}

/// Where nothing is measured, every building has a height of its own before they are merged.
void state_heights(const BuildCityOptions& options, CityModel& raw, HeightBasis& basis) {
  for (std::size_t b = 0; b < basis.size(); ++b) {
    Building& building = raw.buildings[BuildingIndex(b)];
    if (building.attribute_height > 0) continue;
    building.attribute_height = snap_height(options.default_height);
    basis[b] = kDefaultHeight;
  }
}

RoofOptions roof_options(const BuildCityOptions& options) {
  RoofOptions roofs;
  roofs.lod = options.lod;
  roofs.clearance = options.simplify.min_distance;
  roofs.percentile = options.heights.roof_percentile;
  roofs.min_height = options.heights.min_height;
  return roofs;
}

/// What heights of raw buildings rest on.
struct HeightSources {
  BuildingPoints points;
  HeightBasis basis;
};

template <typename Value>
void erase_rows(const std::vector<std::size_t>& rows, std::vector<Value>& values) {
  std::size_t next = 0, kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (next < rows.size() && rows[next] == i)
      ++next;
    else if (kept++ != i)
      values[kept - 1] = std::move(values[i]);
  values.resize(kept);
}

PointLists without_rows(const std::vector<std::size_t>& rows, const PointLists& lists) {
  PointLists rest;
  std::size_t next = 0;
  for (std::size_t i = 0; i < lists.size(); ++i)
    if (next < rows.size() && rows[next] == i)
      ++next;
    else
      rest.push_back(lists[i]);
  return rest;
}

/// Where the points measure ground in a footprint, nothing stands. It is dropped before it can join
/// others, unless it states a height.
void leave_out_unbuilt(const BuildCityOptions& options, const PointCloud& cloud, StepClock& clock,
                       const std::string& source, HeightSources& sources, BuiltCity& result) {
  // Points of the ground alone do not tell what stands on it.
  if (sources.points.roof.values.empty()) return;
  CityModel& raw = result.raw;
  auto& buildings = raw.buildings;
  std::vector<std::size_t> measured =
      clock.run("1.5", "measured ground", [&](const Progress& progress) {
        return find_measured_ground(buildings, sources.points.roof, cloud, result.terrain,
                                    progress);
      });
  std::erase_if(measured, [&](std::size_t b) { return is_planned(buildings[b]); });
  if (measured.empty()) return;
  // What states a height may be newer than the points.
  std::vector<std::size_t> unbuilt;
  if (options.measured_ground == MeasuredGround::kDrop)
    for (const std::size_t b : measured)
      if (!(buildings[b].attribute_height > 0)) unbuilt.push_back(b);
  const std::size_t kept = measured.size() - unbuilt.size();
  std::vector<std::string> parts;
  if (!unbuilt.empty())
    parts.push_back(
        fmt::format("{} are dropped (`measured_ground` = keep keeps them)", unbuilt.size()));
  if (kept > 0)
    parts.push_back(fmt::format("{} are kept{}", kept,
                                options.measured_ground == MeasuredGround::kDrop
                                    ? ", as they state a height and may be newer than the points"
                                    : ""));
  result.warnings.push_back(
      {"measured_ground", static_cast<std::int64_t>(measured.size()),
       fmt::format("the points measure ground in {} footprints and no roof (first: feature {}); {}",
                   measured.size(), buildings[measured.front()].source_ids.front(),
                   fmt::join(parts, ", "))});
  if (unbuilt.empty()) return;
  for (const std::size_t b : unbuilt)
    for (const std::string& id : buildings[b].source_ids)
      raw.dropped.push_back(
          {id, "the points measure ground in it and no roof", DropCause::kNotABuilding});
  erase_rows(unbuilt, buildings);
  erase_rows(unbuilt, sources.basis);
  erase_rows(unbuilt, sources.points.by_exclusion);
  sources.points.roof = without_rows(unbuilt, sources.points.roof);
  sources.points.ground = without_rows(unbuilt, sources.points.ground);
  for (std::size_t b = 0; b < buildings.size(); ++b) buildings[b].id = fmt::format("b{}", b);
  if (buildings.empty() && !options.terrain_only) throw_no_footprint(raw, source);
}

/// Valid as long as `footprints` is.
StatedRoofs stated_roofs(const FootprintsInput& footprints) {
  StatedRoofs stated;
  for (const Footprint& feature : footprints.features)
    if (!feature.roofs.empty()) stated[feature.source_id] = {feature.roofs, feature.base};
  return stated;
}

/// Steps 1.3 to 1.6: `result.raw` and `result.terrain`.
HeightSources make_raw_city(const BuildCityOptions& options, CityInput& input, StepClock& clock,
                            BuiltCity& result) {
  find_ground(options, input, clock, result.input, result.warnings);
  CityModel& raw = result.raw;
  raw.origin = input.points.origin;
  raw.domain = input.domain;
  raw.crs = input.crs;
  result.terrain = make_terrain(options, input, clock, result);
  match_to_terrain(result.terrain, raw.domain, input.footprints, result.warnings);
  std::optional<Domain> outline;
  if (options.domain.shape == DomainShape::kGiven)
    outline = in_local_frame(options.domain.given.sides, raw.origin);
  CleanFeatures clean = clock.run("1.4", "clean footprints", [&](const Progress& progress) {
    return clean_features(options, input.footprints, raw.domain, input.covered, outline,
                          result.warnings, progress);
  });
  result.facts.area_at_boundary = clean.area_lost;
  warn_of_boundary(clean, input.has_points() && !input.has_surface, result.warnings);
  result.input.footprint_parts += clean.parts;
  raw.buildings = std::move(clean.buildings);
  raw.dropped = std::move(clean.dropped);
  if (raw.buildings.empty() && !options.terrain_only)
    throw_no_footprint(raw, input.footprints.source);
  warn_of_country(raw, options, result.warnings);
  warn_of_giants(raw, result.warnings);
  if (!input.has_points()) state_heights(options, raw, clean.basis);
  const PointCloud& cloud = input.points.points;
  HeightSources sources;
  sources.basis = std::move(clean.basis);
  sources.points = clock.run("1.5", "extract points", [&](const Progress& progress) {
    ExtractOptions extract = options.extract;
    extract.no_buildings = input.no_buildings;
    // Towers and low wings are outliers of a building's height, but not of its roof.
    if (options.lod != Lod::kBlock) extract.sigma = kInfinity;
    BuildingPoints extracted =
        extract_building_points(raw.buildings, clean.crossing, cloud, extract, progress);
    forget_roofs_of_planned(raw, extracted);
    // The ground at a building is that of the terrain, if that is known.
    if (input.terrain) extracted.ground = no_points_of(raw.buildings.size());
    return extracted;
  });
  if (input.has_points())
    leave_out_unbuilt(options, cloud, clock, input.footprints.source, sources, result);
  clock.run("1.6", "building heights", [&](const Progress&) {
    compute_heights(raw.buildings, without_outliers(options, sources.points, cloud), cloud,
                    result.terrain, options.heights);
    tell_basis(sources.basis, raw);
  });
  if (input.has_points()) warn_of_missing_roofs(raw, result.warnings);
  warn_of_other_heights(raw, result.warnings);
  const StatedRoofs kept =
      options.lod == Lod::kBlock ? StatedRoofs{} : stated_roofs(input.footprints);
  warn_of_stated_heights(input.footprints, raw, options, kept, result.warnings);
  return sources;
}

/// Steps 2.1 to 2.3: `result.city`.
void merge_buildings(const BuildCityOptions& options, const CityInput& input,
                     const HeightSources& sources, StepClock& clock, BuiltCity& result) {
  const BuildingPoints& points = sources.points;
  HeightBasis basis;
  const CityModel& raw = result.raw;
  CityModel& city = result.city;
  const Simplification simple = clock.run("2.1", "merge footprints", [&](const Progress& progress) {
    Simplification merged =
        simplify_footprints(footprints_of(raw), raw.domain, options.simplify, progress);
    require_each_once(raw, merged);
    return merged;
  });
  clock.run("2.2", "clean merged footprints", [&](const Progress&) {
    city = merged_model(raw, simple, sources.basis, basis);
    require_all_accounted(input.footprints, city);
  });
  if (city.buildings.empty() && !options.terrain_only)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: all {} buildings were dropped (the last, feature {}: {}); lower "
                            "min_building_area or min_building_distance, or add terrain_only",
                            input.footprints.source, raw.buildings.size(),
                            city.dropped.back().source_id, city.dropped.back().reason));
  warn_of_lost_area(raw, simple, result.warnings);
  clock.run("2.3", "heights of merged buildings", [&](const Progress&) {
    compute_heights(city.buildings,
                    merge_building_points(without_outliers(options, points, input.points.points),
                                          simple.members),
                    input.points.points, result.terrain, options.heights);
    tell_basis(basis, city);
    set_heights_of_planned(raw, simple.members, city);
    warn_of_plan(input.footprints, raw, city, options, result.warnings);
    if (options.lod == Lod::kBlock) warn_of_averages(raw, city, simple.members, result.warnings);
  });
  if (options.lod != Lod::kBlock) {
    result.facts.roofs = clock.run("2.3", "roofs", [&](const Progress& progress) {
      return make_roofs(city, raw, points, simple.members, input.points.points,
                        roof_options(options), stated_roofs(input.footprints), progress);
    });
    warn_of_roofs(result.facts.roofs, raw, options.lod, result.warnings);
  }
  if (options.domain.shape != DomainShape::kData)
    result.facts.domain = clock.run("2.3", "domain", [&](const Progress&) {
      // Level ground is a single node.
      const Raster* given = input.terrain ? &input.terrain->raster : nullptr;
      if (given != nullptr && given->values.size() == 1) given = nullptr;
      return fit_wind_domain(options.domain, options.simplify.min_distance, city, result.terrain,
                             result.warnings, given);
    });
  fill_facts(raw, city, simple, result.facts);
  result.facts.account = account_of(result.input, city);
}

}  // namespace

BuiltCity build_city(PointsInput points, FootprintsInput footprints,
                     const BuildCityOptions& options, const StepHooks& hooks) {
  return build_city(CitySources{std::move(points), std::move(footprints)}, options, hooks);
}

BuiltCity build_city(CitySources sources, const BuildCityOptions& options, const StepHooks& hooks) {
  BuiltCity result;
  StepClock clock(hooks, result.steps);
  for (const std::vector<Warning>* warnings :
       {&sources.footprints.warnings, &sources.points.warnings})
    result.warnings.insert(result.warnings.end(), warnings->begin(), warnings->end());
  result.input = facts_of(sources);
  const std::string misread = sources.points.misread;
  HeightSources found;
  CityInput input;
  try {
    input = place_input(std::move(sources), options, result.warnings);
    require_fits(options, input);
    found = make_raw_city(options, input, clock, result);
  } catch (const Error& error) {
    // Points that are misread lead to errors of any kind, and all of them say so.
    if (misread.empty()) throw;
    throw Error(error.kind(), std::string(error.what()) + "; " + misread);
  }
  // Cells of a surface have no class.
  if (options.canopy_heights && !input.has_surface)
    result.canopy_heights = clock.run("1.3", "canopy heights", [&](const Progress&) {
      return measure_canopies(input.points.points, result.terrain);
    });
  merge_buildings(options, input, found, clock, result);
  result.footprints = std::move(input.footprints);
  if (result.input.points_kept > 0)
    warn_of_exclusion(found.points, result.input.points_kept, result.warnings);
  return result;
}

}  // namespace tetropolis
