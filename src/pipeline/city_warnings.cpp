#include "city_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/raster.h"

#include "core/median.h"
#include "core/text.h"

namespace tetropolis {

namespace {

/// Share of empty nodes above which a terrain is more guess than data.
constexpr double kMostlyEmpty = 0.75;

/// Share of squares of 20 m without a ground point above which something is missing: more than
/// blocks of buildings and waters take up in a city.
constexpr double kManyVoids = 0.35;

/// Share of buildings without roof points from which on it is not the buildings that are odd.
constexpr double kManyRoofless = 0.1;

}  // namespace

void warn_of_terrain(const DtmReport& dtm, bool filtered, std::vector<Warning>& warnings) {
  const char* const advice =
      filtered ? "raise ground_filter_slope or lower ground_filter_window if the filter took "
                 "terrain for "
                 "objects"
               : "use ground_filter = always if part of the cloud is not classified";
  if (dtm.empty_share > kMostlyEmpty)
    warnings.push_back(
        {"terrain_mostly_filled",
         static_cast<std::int64_t>(dtm.empty_share * static_cast<double>(dtm.nodes)),
         fmt::format(
             "{:.0f} % of the terrain's nodes have no ground point nearby; they were filled from "
             "their neighbours; check `bounds`, raise dtm_step, or {}",
             100 * dtm.empty_share, advice)});
  else if (dtm.void_share > kManyVoids)
    warnings.push_back(
        {"terrain_voids", dtm.voids,
         fmt::format(
             "{:.0f} % of the domain's squares of 20 m have no ground point; the terrain there is "
             "filled from around; check `bounds`, or {}",
             100 * dtm.void_share, advice)});
}

namespace {

/// What stands on the ground lies above it: more below it than above, and it is not the ground.
void warn_of_low_surface(const CityInput& input, std::span<const double> above,
                         std::vector<Warning>& warnings) {
  constexpr double kNoise = 1, kFew = 0.05;  // metres; a share
  const auto all = static_cast<double>(above.size());
  const auto below =
      std::count_if(above.begin(), above.end(), [](double z) { return z < -kNoise; });
  const auto over = std::count_if(above.begin(), above.end(), [](double z) { return z > kNoise; });
  if (below <= over || static_cast<double>(below) <= kFew * all) return;
  warnings.push_back(
      {"surface_below_terrain", below,
       fmt::format("{:.0f} % of {} lie more than {:g} m below {}, {:.0f} % as far above "
                   "it; swap `dsm` and `dtm`, or are their heights of two vertical systems?",
                   100 * static_cast<double>(below) / all, input.points.source, kNoise,
                   input.terrain->source, 100 * static_cast<double>(over) / all)});
}

}  // namespace

void warn_off_terrain(const CityInput& input, const Raster& terrain,
                      std::vector<Warning>& warnings) {
  constexpr double kMostOff = 3;  // metres, of the median
  constexpr std::size_t kEnough = 10'000;
  const PointCloud& cloud = input.points.points;
  const auto counts = [&](std::size_t p) {
    return (input.has_surface || cloud.classification[p] == kGround) &&
           input.domain.contains({cloud.x[p], cloud.y[p]});
  };
  std::size_t count = 0, number = 0;
  for (std::size_t p = 0; p < cloud.size(); ++p) count += counts(p) ? 1 : 0;
  if (count == 0) return;
  const std::size_t step = count / kEnough + 1;
  std::vector<double> above;
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (counts(p) && number++ % step == 0)
      above.push_back(cloud.z[p] - sample(terrain, {cloud.x[p], cloud.y[p]}));
  if (input.has_surface) {
    warn_of_low_surface(input, above, warnings);
    return;
  }
  const double off = median(above);
  if (std::abs(off) <= kMostOff) return;
  warnings.push_back(
      {"points_off_terrain", static_cast<std::int64_t>(count),
       fmt::format("{}: points of the ground lie {:.1f} m {} this terrain (median); are its "
                   "heights of another vertical system or unit than those of {}?",
                   input.terrain->source, std::abs(off), off > 0 ? "above" : "below",
                   input.points.source)});
}

void warn_of_boundary(const CleanFeatures& clean, bool has_cloud, std::vector<Warning>& warnings) {
  constexpr double kMost = 0.05;
  if (!(clean.area_lost > kMost * clean.area)) return;
  const auto lost = std::count_if(clean.dropped.begin(), clean.dropped.end(),
                                  [](const Dropped& d) { return d.cause == DropCause::kBoundary; });
  warnings.push_back(
      {"boundary_loss", lost,
       fmt::format(
           "{:.0f} % of the footprint area{} is dropped at the domain's boundary; give {}, or keep "
           "their parts inside by `boundary_buildings` = clip",
           100 * clean.area_lost / clean.area, has_cloud ? " with points" : "",
           has_cloud ? "points around these buildings or `bounds` that hold them whole"
                     : "`bounds` that hold these buildings whole")});
}

void warn_of_country(const CityModel& raw, const BuildCityOptions& options,
                     std::vector<Warning>& warnings) {
  if (options.bounds) return;
  const auto outside = std::count_if(raw.dropped.begin(), raw.dropped.end(), [](const Dropped& d) {
    return d.cause == DropCause::kOutside;
  });
  if (outside <= kMostListedBeyond) return;
  const Bounds2 box = raw.domain.moved(raw.origin).bounds();
  warnings.push_back(
      {"footprints_outside", outside,
       fmt::format(
           "{} footprints outside the domain were read whole and are listed one by one; with "
           "`bounds` = {:.10g},{:.10g},{:.10g},{:.10g} that takes less time and memory",
           outside, box.xmin, box.ymin, box.xmax, box.ymax)});
}

void warn_of_giants(const CityModel& raw, std::vector<Warning>& warnings) {
  constexpr double kMost = 0.5;
  const double domain = raw.domain.area();
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
  if (warning.count > 0) warnings.push_back(warning);
}

void warn_of_missing_roofs(const CityModel& raw, std::vector<Warning>& warnings) {
  const auto roofless =
      std::count_if(raw.buildings.begin(), raw.buildings.end(),
                    [](const Building& building) { return (building.flags & kNoRoofPoints) != 0; });
  const auto all = static_cast<double>(raw.buildings.size());
  if (static_cast<double>(roofless) <= kManyRoofless * all) return;
  warnings.push_back(
      {"no_roof_points", roofless,
       fmt::format("{} of {} buildings have no roof points and get the minimum height; is part of "
                   "the cloud not classified, or missing?",
                   roofless, raw.buildings.size())});
}

namespace {

/// Attributes that may be heights or floors, by their names.
std::vector<std::string> columns_of_heights(const FootprintsInput& footprints) {
  constexpr std::array kWords{"height", "hoogte", "hohe",   "hoehe",   "haut",
                              "altura", "floor",  "storey", "stories", "building_l",
                              "level",  "etage",  "gescho", "lagen",   "verdieping"};
  std::vector<std::string> names;
  for (const AttributeColumn& column : footprints.attributes) {
    const std::string name = lower_case(column.name);
    if (std::any_of(kWords.begin(), kWords.end(),
                    [&](const char* word) { return name.find(word) != std::string::npos; }))
      names.push_back(column.name);
  }
  return names;
}

}  // namespace

void warn_of_stated_heights(const FootprintsInput& footprints, const CityModel& raw,
                            const BuildCityOptions& options, const StatedRoofs& kept,
                            std::vector<Warning>& warnings) {
  const auto count = [&](std::uint32_t flag) {
    return std::count_if(raw.buildings.begin(), raw.buildings.end(), [&](const Building& building) {
      return (building.flags & flag) != 0 &&
             find_body(kept, building.source_ids.front()) == nullptr;
    });
  };
  const auto by_attribute = count(kRoofFromAttribute), by_floors = count(kRoofFromFloors),
             by_default = count(kDefaultHeight);
  // What is taken for heights matters where it is used.
  if (by_attribute == 0)
    std::erase_if(warnings, [](const Warning& w) { return w.code == "height_assumed"; });
  const auto stated = by_attribute + by_floors + by_default;
  if (stated == 0) return;
  std::vector<std::string> parts;
  if (by_attribute > 0) parts.push_back(fmt::format("{} the height that they state", by_attribute));
  if (by_floors > 0) parts.push_back(fmt::format("{} that of their floors", by_floors));
  if (by_default > 0)
    parts.push_back(fmt::format("{} that state neither get {:g} m (default_height)", by_default,
                                options.default_height));
  std::string message = fmt::format("{} of {} footprints have no measured roof: {}", stated,
                                    raw.buildings.size(), fmt::join(parts, ", "));
  if (const auto columns = columns_of_heights(footprints); by_default == stated && !columns.empty())
    message += fmt::format(
        "; if {} tells heights or floors, name it with height_attribute or "
        "floors_attribute",
        fmt::join(columns, " or "));
  warnings.push_back({"heights_stated", stated, message});
}

void warn_of_other_heights(const CityModel& raw, std::vector<Warning>& warnings) {
  constexpr std::uint32_t kNotMeasured =
      kRoofFromAttribute | kRoofFromFloors | kDefaultHeight | kNoRoofPoints | kMinimumHeight;
  std::vector<double> ratios;
  for (const Building& building : raw.buildings)
    if ((building.flags & kNotMeasured) == 0 && building.attribute_height > 0)
      ratios.push_back(building.attribute_height / (building.h_roof - building.h_ground));
  constexpr std::size_t kFew = 2, kEnough = 5;
  if (ratios.size() < kFew) return;
  const std::size_t count = ratios.size();
  const double median = percentile(ratios, 50);
  constexpr double kFeet = 1 / 0.3048, kNear = 0.06, kThird = 1.0 / 3;
  const bool feet = std::abs(median / kFeet - 1) <= kNear;
  if (!feet && (count < kEnough || std::abs(median - 1) <= kThird)) return;
  warnings.push_back(
      {"heights_differ", static_cast<std::int64_t>(count),
       fmt::format("heights that features state are {:.2f} times the measured ones (median of {} "
                   "buildings with both); {}",
                   median, count,
                   feet ? "are they in feet? then set `height_unit` = ft"
                        : "are they heights of another kind or unit, or of another time?")});
}

void warn_of_plan(const FootprintsInput& footprints, const CityModel& raw, const CityModel& city,
                  const BuildCityOptions& options, std::vector<Warning>& warnings) {
  std::set<std::string_view> planned;
  const auto note = [&](const auto& features) {
    for (const auto& feature : features)
      if (feature.is_planned) planned.insert(feature.source_id);
  };
  note(footprints.features);
  note(footprints.dropped);
  if (planned.empty()) return;
  Warning lost{"planned_left_out", 0, {}};
  for (const Dropped& dropped : city.dropped)
    if (dropped.cause != DropCause::kReplaced && planned.contains(dropped.source_id) &&
        lost.count++ == 0)
      lost.message = fmt::format("{}: {}", dropped.source_id, dropped.reason);
  if (lost.count > 0) {
    lost.message = fmt::format("{} of {} features of the plan have no effect (the first, {})",
                               lost.count, planned.size(), lost.message);
    warnings.push_back(lost);
  }
  constexpr std::uint32_t kRaised = kPlanned | kMinimumHeight;
  Warning raised{"planned_raised", 0, {}};
  for (const Building& building : raw.buildings)
    if ((building.flags & kRaised) == kRaised && raised.count++ == 0)
      raised.message =
          fmt::format("{}, {:g} m", building.source_ids.front(), building.attribute_height);
  if (raised.count > 0) {
    raised.message = fmt::format(
        "{} planned buildings state heights below {:g} m (min_building_height) and get that (the "
        "first, {})",
        raised.count, options.heights.min_height, raised.message);
    warnings.push_back(raised);
  }
}

void warn_of_averages(const CityModel& raw, const CityModel& city,
                      std::span<const std::vector<BuildingIndex>> members,
                      std::vector<Warning>& warnings) {
  constexpr double kMost = 1;  // metres
  constexpr std::uint32_t kStated = kPlanned | kRoofFromAttribute | kRoofFromFloors;
  Warning averaged{"heights_averaged", 0, {}};
  std::int64_t stated = 0;
  double worst = 0;
  for (std::size_t b = 0; b < members.size(); ++b)
    for (const BuildingIndex m : members[b]) {
      const Building& member = raw.buildings[m];
      if ((member.flags & kStated) == 0) continue;
      ++stated;
      const double moved = city.buildings[BuildingIndex(b)].h_roof - member.h_roof;
      const double off = std::abs(moved);
      if (off > kMost) ++averaged.count;
      if (off <= std::max(worst, kMost)) continue;
      worst = off;
      averaged.message =
          fmt::format("{}, {:.1f} m high, its roof {:.1f} m {}", member.source_ids.front(),
                      member.h_roof - member.h_ground, off, moved > 0 ? "higher" : "lower");
    }
  if (averaged.count == 0) return;
  averaged.message = fmt::format(
      "{} of {} buildings that state heights are part of blocks of another (most, {}); with `lod` "
      "= "
      "1.2 they keep theirs",
      averaged.count, stated, averaged.message);
  warnings.push_back(averaged);
}

void warn_of_exclusion(const BuildingPoints& points, std::int64_t all_points,
                       std::vector<Warning>& warnings) {
  const std::vector<std::uint8_t>& marks = points.by_exclusion;
  if (const auto clean = std::count(marks.begin(), marks.end(), 2); clean > 0)
    warnings.push_back(
        {"roofs_without_class", clean,
         fmt::format("{} footprints have no points of class 6 (building) but a clean roof of other "
                     "points, which is used",
                     clean)});
  const auto count = std::count(marks.begin(), marks.end(), 1);
  if (count == 0) return;
  const bool everywhere = count == std::ssize(marks);
  const char* const taken =
      "roof points are those inside footprints that are neither ground, water, vegetation, noise, "
      "wires nor bridge decks";
  if (everywhere)
    warnings.push_back(
        {"no_building_class", all_points,
         fmt::format("the cloud has no class 6 (building), or stray points of it; {}", taken)});
  else
    warnings.push_back(
        {"building_class_partly", count,
         fmt::format("{} buildings are in files without class 6 (building); their {}", count,
                     taken)});
}

void warn_of_lost_area(const CityModel& raw, const Simplification& simple,
                       std::vector<Warning>& warnings) {
  Warning warning{"footprint_mostly_lost", 0, {}};
  for (std::size_t i = 0; i < simple.footprints.size(); ++i) {
    const double left = area(simple.footprints[i]);
    const double changed = simple.changes[i].symmetric_difference;
    if (changed <= left) continue;  // what was filled is part of what is left
    if (warning.count++ > 0) continue;
    const BuildingIndex first = simple.members[i].front();
    warning.message = fmt::format(
        "lost more than half of their area where they are narrower than min_building_distance; the "
        "first is feature {}, of which {:.0f} m2 are left ({:.0f} m2 changed)",
        raw.buildings[first].source_ids.front(), left, changed);
  }
  if (warning.count == 0) return;
  warning.message = fmt::format("{} footprints {}", warning.count, warning.message);
  warnings.push_back(warning);
}

void warn_of_roofs(const RoofFacts& roofs, const CityModel& raw, Lod lod,
                   std::vector<Warning>& warnings) {
  if (!roofs.lost.empty())
    warnings.push_back(
        {"roofs_of_neighbours", std::ssize(roofs.lost),
         fmt::format(
             "{} of {} footprints have the roof of a neighbour, 2 m or more off (the first, "
             "{}): lines between them find no room; a smaller min_building_distance has it",
             roofs.lost.size(), raw.buildings.size(), roofs.lost.front())});
  constexpr double kMany = 0.25;
  const std::int64_t with_points = roofs.parts - roofs.parts_without_points;
  if (static_cast<double>(roofs.fallbacks) <= kMany * static_cast<double>(with_points)) return;
  warnings.push_back(
      {"roofs_below_lod", roofs.fallbacks,
       fmt::format("{} of {} parts of roofs stay below LoD{}, because their points are too few or "
                   "fit a flat roof better; ask for a lower `lod`, or add points",
                   roofs.fallbacks, with_points, name_of(lod))});
}

}  // namespace tetropolis
