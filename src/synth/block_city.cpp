#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/synth/synthetic_city.h"

#include "blocks.h"
#include "city/share_corners.h"
#include "roofs.h"
#include "scan.h"
#include "seeded_random.h"
#include "street_plan.h"
#include "vegetation.h"

namespace tetropolis {

namespace {

constexpr std::uint64_t kBlockStream = 100;  // The first of one stream per block.
constexpr std::uint64_t kGreenStream = 4;
constexpr std::uint64_t kUntidyStream = 5;
constexpr std::uint64_t kRoofSeed = 0x726f6f66;
constexpr std::uint64_t kBlockScanSeed = 0x626c6f636b;

void check(const BlockCityOptions& options) {
  const auto refuse = [](const char* what) {
    throw Error(ErrorKind::kUsage, fmt::format("cannot make a city of blocks: {}", what));
  };
  if (!(options.size >= 300 && options.size <= 1e5)) refuse("the size must be in [300, 100000] m");
  if (!(options.points_per_m2 >= 0 && options.points_per_m2 <= 1000))
    refuse("the point density must be in [0, 1000] per m2");
  if (!(options.relief >= 0)) refuse("the relief must not be negative");
  if (!(options.margin >= 0 && options.margin <= options.size / 4))
    refuse("the margin must be at most a quarter of the size");
  if (options.buildings < 0) refuse("the number of buildings must not be negative");
}

/// The buildings of all blocks. Every block has its own random stream, so that one more building on
/// one of them does not change the others.
std::vector<SyntheticBuilding> build(const StreetPlan& plan, std::uint64_t seed, double scale) {
  std::vector<SyntheticBuilding> buildings;
  std::size_t roomy = 0;
  for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
    SeededRandom random(seed, kBlockStream + b);
    // The second block that is large enough, and then a few more.
    const bool room = has_room_for_courtyard(plan.blocks[b]);
    const bool around_a_courtyard = room && (roomy == 1 || (roomy > 1 && random.chance(0.07)));
    if (room) ++roomy;
    build_on_block(plan.blocks[b], {scale, around_a_courtyard}, random, buildings);
  }
  return buildings;
}

/// The plots' scale at which the number of buildings comes closest to the wanted one.
std::vector<SyntheticBuilding> build_about(const StreetPlan& plan, std::uint64_t seed,
                                           std::int64_t wanted) {
  std::vector<SyntheticBuilding> best = build(plan, seed, 1);
  if (wanted <= 0) return best;
  const auto miss = [&](const std::vector<SyntheticBuilding>& buildings) {
    return std::abs(static_cast<std::int64_t>(buildings.size()) - wanted);
  };
  double scale = 1;
  std::size_t count = best.size();
  constexpr int kTries = 8;
  for (int k = 0; k < kTries && miss(best) > 0; ++k) {
    const double ratio = static_cast<double>(count) / static_cast<double>(wanted);
    scale = std::clamp(scale * std::clamp(ratio, 0.5, 2.0), 0.45, 4.0);
    std::vector<SyntheticBuilding> next = build(plan, seed, scale);
    count = next.size();
    if (miss(next) < miss(best)) best = std::move(next);
  }
  return best;
}

std::vector<SyntheticBridge> build_bridges(const StreetPlan& plan, double size) {
  std::vector<SyntheticBridge> bridges;
  const SyntheticTerrain& terrain = plan.terrain;
  for (const double x : plan.crossings) {
    // Southern and northern end of the water on this line, and a little more on either side.
    double south = size;
    double north = 0;
    for (double y = 0; y < size; y += 0.5) {
      if (synthetic_river_distance(terrain, x, y) > terrain.river_half_width + 2.5) continue;
      south = std::min(south, y);
      north = std::max(north, y);
    }
    if (south < north) bridges.push_back({{x, (south + north) / 2}, 5.5, (north - south) / 2});
  }
  return bridges;
}

void shift(Polygon& footprint, Point2 by) {
  for_each_vertex(footprint, [&](Point2& p) {
    p = {round_to_mm(p.x + by.x), round_to_mm(p.y + by.y)};
  });
}

/// Small faults of the kind that cadastral footprints have. The points know nothing of them.
void make_untidy(SyntheticCity& city, SeededRandom& random) {
  for (Polygon& footprint : city.footprints) {
    const double what = random.unit();
    if (what < 0.05) {
      const double dx = random.uniform(-0.05, 0.05);
      const double dy = random.uniform(-0.05, 0.05);
      shift(footprint, {dx, dy});
      ++city.counts.shifted;
    } else if (what < 0.08) {
      const std::size_t at = random.bits() % footprint.outer.size();
      const Point2 here = footprint.outer[at];
      const Point2 next = footprint.outer[(at + 1) % footprint.outer.size()];
      // A vertex twice, or one more on an edge, a third of the way along.
      const double share = random.chance(0.5) ? 0.0 : 1.0 / 3;
      const Point2 extra{round_to_mm(here.x + share * (next.x - here.x)),
                         round_to_mm(here.y + share * (next.y - here.y))};
      footprint.outer.insert(footprint.outer.begin() + static_cast<std::ptrdiff_t>(at) + 1, extra);
      ++city.counts.extra_vertices;
    }
  }
}

/// Gives the scene's buildings their parts. Every building has its own random stream.
void add_roofs(std::uint64_t seed, SyntheticScene& scene, SyntheticCity& city) {
  CityModel& truth = city.truth;
  truth.origin = city.origin;
  truth.domain = city.domain;
  truth.crs = city.crs;
  for (std::size_t b = 0; b < scene.buildings.size(); ++b) {
    SeededRandom random(mix64(seed ^ kRoofSeed), b);
    std::vector<RoofPart>& parts =
        scene.parts.emplace_back(build_roof(scene.buildings[b], city.ground[b], random));
    Building& building = truth.buildings.emplace_back();
    building.id = fmt::format("b{}", b);
    building.source_ids = {city.ids[b]};
    building.footprint = scene.buildings[b].footprint;
    building.h_ground = city.ground[b];
    building.h_roof = snap_height(scene.roofs[b]);
    std::vector<Polygon> outlines;
    for (RoofPart& part : parts) {
      part.source_id = city.ids[b];
      outlines.push_back(part.outline);
    }
    if (!parts.empty()) building.footprint = common_outline(outlines).value();
    building.parts = parts;
  }
}

}  // namespace

SyntheticCity synthetic_block_city(const BlockCityOptions& options, const Progress& progress) {
  check(options);
  const StreetPlan plan = plan_streets(options);
  SyntheticScene scene;
  scene.size = options.size;
  scene.terrain = plan.terrain;
  scene.details = true;
  scene.buildings = build_about(plan, options.seed, options.buildings);
  scene.bridges = build_bridges(plan, options.size);
  SeededRandom green(options.seed, kGreenStream);
  plant_and_park(plan, green, scene);
  SyntheticCity city = city_of_scene(scene);
  if (options.sloped_roofs) add_roofs(options.seed, scene, city);
  city.points =
      scan_scene(scene, options.points_per_m2, mix64(options.seed ^ kBlockScanSeed), progress);
  if (options.untidy) {
    SeededRandom random(options.seed, kUntidyStream);
    make_untidy(city, random);
  }
  return city;
}

}  // namespace tetropolis
