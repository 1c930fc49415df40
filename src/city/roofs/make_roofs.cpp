#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "tetropolis/city/heights.h"
#include "tetropolis/city/roofs.h"
#include "tetropolis/geometry/polygon.h"

#include "city/roofs/plane_fit.h"
#include "city/roofs/roof_of_building.h"
#include "city/roofs/sample_roofs.h"
#include "city/roofs/separate_valleys.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/shared_progress.h"
#include "geometry/perimeter.h"

namespace tetropolis {

namespace {

/// What the facts are made of, of one building.
struct BuildingFacts {
  RoofFacts facts;
  std::vector<double> rmse;  ///< Of its footprints with enough points.
};

bool states_height(const Building& footprint) {
  constexpr std::uint32_t kStated = kRoofFromAttribute | kRoofFromFloors | kDefaultHeight;
  return (footprint.flags & kStated) != 0;
}

/// Points of a roof at the stated height.
std::vector<Point3> sample_level_roof(const Building& footprint) {
  const Point2 p = footprint.footprint.outer.front();
  const double height = footprint.h_roof - footprint.h_ground;
  const StatedRoof level{footprint.footprint,
                         {p, Point2{p.x + 1, p.y}, Point2{p.x, p.y + 1}},
                         {height, height, height}};
  return sample_roofs(std::span(&level, 1), footprint.footprint, footprint.h_ground);
}

RoofInput input_of(const Building& building, const CityModel& raw, const BuildingPoints& points,
                   const std::vector<BuildingIndex>& members, const PointCloud& cloud,
                   const StatedRoofs& stated) {
  RoofInput input;
  input.footprint = building.footprint;
  for (const BuildingIndex m : members) {
    const Building& footprint = raw.buildings[m];
    input.members.push_back(&footprint.footprint);
    input.heights.push_back(footprint.h_roof);
    std::vector<Point3> list;
    for (const PointIndex p : points.roof[m]) list.push_back({cloud.x[p], cloud.y[p], cloud.z[p]});
    RoofSource source = RoofSource::kMeasured;
    if (const StatedBody* body = find_body(stated, footprint.source_ids.front());
        list.empty() && body != nullptr) {
      const double base = std::isfinite(body->base) ? body->base : footprint.h_ground;
      list = sample_roofs(body->roofs, footprint.footprint, base);
      source = RoofSource::kStated;
    } else if (list.empty() && members.size() > 1 && states_height(footprint)) {
      list = sample_level_roof(footprint);
      source = RoofSource::kLevel;
    }
    input.points.push_back(list);
    input.sources.push_back(source);
  }
  return input;
}

void count(const FinishedRoof& roof, const Building& building, Lod wanted, BuildingFacts& result) {
  RoofFacts& facts = result.facts;
  for (const FinishedPart& finished : roof.parts) {
    const RoofPart& part = finished.part;
    if (part.lod < wanted && part.n_points > 0) ++facts.fallbacks;
    if (finished.raised) ++facts.raised;
    facts.max_slope_deg =
        std::max(facts.max_slope_deg, std::atan(slope_of(part.roof)) * 180 / std::numbers::pi);
    const double size = area(part.outline);
    facts.volume_of_points +=
        size * (finished.mean_of_roof + finished.mean_above - building.h_ground);
    facts.volume += size * (finished.mean_of_roof - building.h_ground);
    facts.volume_of_blocks += size * (building.h_roof - building.h_ground);
  }
  for (std::size_t m = 0; m < roof.counts.size(); ++m)
    if (roof.has_fit(m))
      result.rmse.push_back(
          std::sqrt(roof.squared_errors[m] / static_cast<double>(roof.counts[m])));
}

/// The ground of a building, as low as that of members whose roofs would have to be raised for it:
/// houses in a row down a slope.
double ground_below(const Building& building, const CityModel& raw,
                    const std::vector<BuildingIndex>& members, double min_height) {
  double ground = building.h_ground;
  for (const BuildingIndex m : members)
    if (raw.buildings[m].h_roof < building.h_ground + min_height)
      ground = std::min(ground, raw.buildings[m].h_ground);
  return ground;
}

/// A roof as good as can be, and the building with its parts.
struct Attempt {
  FinishedRoof roof;
  Building building;
  bool is_valid = false;
};

Attempt attempt(const Building& building, const RoofInput& input, const RoofFindings& found,
                const CityModel& raw, const std::vector<BuildingIndex>& members,
                const RoofOptions& options) {
  Attempt result;
  const double lowest = building.h_ground + options.min_height;
  result.roof = roof_of_building(input, found, options, building.h_roof, lowest);
  result.building = building;
  result.building.footprint = result.roof.footprint;
  for (FinishedPart& finished : result.roof.parts) {
    const Building& footprint = raw.buildings[members[static_cast<std::size_t>(finished.member)]];
    finished.part.source_id = footprint.source_ids.front();
    result.building.parts.push_back(finished.part);
  }
  result.is_valid =
      part_defects(std::span(&result.building, 1), options.clearance, options.min_area, 1).empty();
  return result;
}

/// Square metres by which roofs at stated heights are larger or smaller than the footprints that
/// state them, beyond what closing gaps explains; 0 where nothing else is in the building.
double off_stated_heights(const Attempt& made, const RoofInput& input, double clearance) {
  if (std::count(input.sources.begin(), input.sources.end(), RoofSource::kLevel) ==
      std::ssize(input.sources))
    return 0;
  std::map<double, double> excess;
  double allowed = 0;
  for (std::size_t m = 0; m < input.members.size(); ++m) {
    if (input.sources[m] != RoofSource::kLevel || input.points[m].empty()) continue;
    excess[snap_height(input.points[m].front()[2])] -= area(*input.members[m]);
    allowed += perimeter(*input.members[m]) * clearance / 8;
  }
  for (const RoofPart& part : made.building.parts)
    if (const auto at = excess.find(part.roof.elevation); at != excess.end() && part.roof.is_flat())
      at->second += area(part.outline);
  double sum = 0;
  for (const auto& [height, size] : excess) sum += std::abs(size);
  return std::max(0.0, sum - allowed);
}

BuildingFacts make_roof(Building& building, const RoofInput& input, const CityModel& raw,
                        const std::vector<BuildingIndex>& members, const RoofOptions& options) {
  BuildingFacts result;
  building.h_ground = ground_below(building, raw, members, options.min_height);
  const RoofFindings found = find_planes(input, options);
  RoofOptions tried = options;
  // What cannot keep its clearance, or does not reach stated heights where they are, is made with
  // fewer lines: party walls alone, then none.
  std::optional<Attempt> best;
  double least = kInfinity;
  for (const Lod lod : {options.lod, Lod::k1_2}) {
    tried.lod = lod;
    Attempt made = attempt(building, input, found, raw, members, tried);
    if (!made.is_valid) continue;
    const double off = off_stated_heights(made, input, options.clearance);
    if (off < least) least = off, best = std::move(made);
    if (least == 0 || options.lod == Lod::k1_2) break;
  }
  if (!best) {
    result.facts.undivided = 1;
    return result;
  }
  result.facts.shared_wall_corners =
      separate_valleys(best->building, options.clearance, options.min_area);
  building = std::move(best->building);
  count(best->roof, building, options.lod, result);
  for (const MemberNumber m : best->roof.lost)
    result.facts.lost.push_back(
        raw.buildings[members[static_cast<std::size_t>(m)]].source_ids.front());
  result.facts.parts = static_cast<std::int64_t>(building.parts.size());
  for (const RoofPart& part : building.parts) {
    ++result.facts.parts_by_lod[name_of(part.lod)];
    if (part.n_points == 0) ++result.facts.parts_without_points;
  }
  return result;
}

void add(const BuildingFacts& one, BuildingFacts& all) {
  RoofFacts& sum = all.facts;
  sum.parts += one.facts.parts;
  for (const auto& [lod, number] : one.facts.parts_by_lod) sum.parts_by_lod[lod] += number;
  sum.fallbacks += one.facts.fallbacks;
  sum.parts_without_points += one.facts.parts_without_points;
  sum.raised += one.facts.raised;
  sum.lost.insert(sum.lost.end(), one.facts.lost.begin(), one.facts.lost.end());
  sum.undivided += one.facts.undivided;
  sum.shared_wall_corners += one.facts.shared_wall_corners;
  sum.max_slope_deg = std::max(sum.max_slope_deg, one.facts.max_slope_deg);
  sum.volume_of_points += one.facts.volume_of_points;
  sum.volume += one.facts.volume;
  sum.volume_of_blocks += one.facts.volume_of_blocks;
  all.rmse.insert(all.rmse.end(), one.rmse.begin(), one.rmse.end());
}

}  // namespace

RoofFacts make_roofs(CityModel& city, const CityModel& raw, const BuildingPoints& points,
                     std::span<const std::vector<BuildingIndex>> members, const PointCloud& cloud,
                     const RoofOptions& options, const StatedRoofs& stated,
                     const Progress& progress) {
  if (options.lod == Lod::kBlock) return {};
  std::vector<BuildingFacts> facts(city.buildings.size());
  SharedProgress shared(progress, city.buildings.size());
  parallel_chunks(city.buildings.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      Building& building = city.buildings[b];
      facts[b] = make_roof(building, input_of(building, raw, points, members[b], cloud, stated),
                           raw, members[b], options);
      shared.add(1);
    }
  });
  BuildingFacts all;
  for (const BuildingFacts& one : facts) add(one, all);
  if (!all.rmse.empty()) {
    all.facts.rmse_median = percentile(all.rmse, 50);
    all.facts.rmse_p90 = percentile(all.rmse, 90);
  }
  return all.facts;
}

}  // namespace tetropolis
