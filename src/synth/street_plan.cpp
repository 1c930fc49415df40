#include "street_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tetropolis/geometry/polygon.h"

#include "convex.h"
#include "seeded_random.h"

namespace tetropolis {

namespace {

using namespace convex;

constexpr std::uint64_t kPlanStream = 3;
constexpr double kHalfAvenue = 9;
constexpr double kQuay = 9;                // Metres of open bank along the river.
constexpr double kSmallestQuarter = 1500;  // Square metres.

/// Cosine and sine of 0, 9, 13, 16, 23, 28 and 37 degrees, roughly: Pythagorean triples, exact
/// rotations without trigonometry.
constexpr std::array<Point2, 7> kAxes = {{{1, 0},
                                          {84.0 / 85, 13.0 / 85},
                                          {40.0 / 41, 9.0 / 41},
                                          {24.0 / 25, 7.0 / 25},
                                          {12.0 / 13, 5.0 / 13},
                                          {15.0 / 17, 8.0 / 17},
                                          {4.0 / 5, 3.0 / 5}}};

struct Grid {
  std::int64_t n;  ///< Seeds of quarters per side.
  double spacing;
};

Grid seed_grid(double size) {
  const double wanted = std::clamp(size / 3, 150.0, 260.0);
  const auto n =
      std::max<std::int64_t>(2, static_cast<std::int64_t>(std::nearbyint(size / wanted)));
  return {n, size / static_cast<double>(n)};
}

/// The river runs between two rows of quarters, somewhat south of the middle.
SyntheticTerrain make_terrain(const BlockCityOptions& options, const Grid& grid,
                              SeededRandom& random) {
  SyntheticTerrain terrain;
  terrain.relief = options.relief;
  for (double& phase : terrain.phases) phase = random.unit();
  const double row = std::max(1.0, std::nearbyint(0.36 * static_cast<double>(grid.n)));
  terrain.river = true;
  terrain.river_y = row * grid.spacing + random.uniform(-0.05, 0.1) * grid.spacing;
  terrain.river_amplitude = std::min(0.045 * options.size, 45.0);
  terrain.river_wavelength = random.uniform(620, 760);
  terrain.river_phase = random.unit();
  terrain.river_half_width = std::clamp(0.03 * options.size, 11.0, 24.0);
  terrain.water_level = terrain.base - 3.5;
  terrain.valley = std::clamp(0.3 * options.size, 60.0, 250.0);
  return terrain;
}

/// One seed per grid cell, in rows from the south.
std::vector<Point2> quarter_seeds(const Grid& grid, SeededRandom& random) {
  std::vector<Point2> seeds;
  for (std::int64_t j = 0; j < grid.n; ++j)
    for (std::int64_t i = 0; i < grid.n; ++i) {
      const double x = static_cast<double>(i) + 0.5 + random.uniform(-0.24, 0.24);
      const double y = static_cast<double>(j) + 0.5 + random.uniform(-0.24, 0.24);
      seeds.push_back(grid.spacing * Point2{x, y});
    }
  return seeds;
}

/// The Voronoi cell of a seed, less half an avenue all around, within the margins.
Ring quarter_ring(const std::vector<Point2>& seeds, std::size_t own, const Grid& grid,
                  const BlockCityOptions& options) {
  const double low = options.margin;
  const double high = options.size - options.margin;
  Ring ring{{low, low}, {high, low}, {high, high}, {low, high}};
  for (std::size_t other = 0; other < seeds.size() && !ring.empty(); ++other) {
    const Point2 apart = seeds[own] - seeds[other];
    if (other == own || length(apart) > 4 * grid.spacing) continue;
    const Point2 away = unit(apart);
    ring = clip(ring, seeds[other] + (length(apart) / 2 + kHalfAvenue) * away, away);
  }
  return ring;
}

/// The river's centre line at x.
double river_y(const SyntheticTerrain& terrain, double x) {
  // The distance is measured along y from far above, where it is the difference of ordinates
  // divided by a factor that a second probe cancels.
  const double at_zero = synthetic_river_distance(terrain, x, 1e6);
  const double at_one = synthetic_river_distance(terrain, x, 2e6);
  return 1e6 - at_zero / (at_one - at_zero) * 1e6;
}

/// The part of a quarter north (side = 1) or south (side = -1) of the river and its quay: cut along
/// a chord of the centre line, moved until it clears the bank everywhere.
Ring beside_river(const Ring& ring, const SyntheticTerrain& terrain, double side) {
  const Bounds2 box = bounds(ring);
  const Point2 west{box.xmin, river_y(terrain, box.xmin)};
  const Point2 east{box.xmax, river_y(terrain, box.xmax)};
  const Point2 normal = side * left_of(unit(east - west));
  constexpr int kSamples = 40;
  double reach = 0;
  for (int k = 0; k <= kSamples; ++k) {
    const double x = box.xmin + box.width() * k / kSamples;
    reach = std::max(reach, dot(normal, Point2{x, river_y(terrain, x)} - west));
  }
  return clip(ring, west + (reach + terrain.river_half_width + kQuay) * normal, normal);
}

Point2 random_axis(SeededRandom& random) {
  if (random.chance(0.3)) return kAxes[0];
  const Point2 axis = kAxes[static_cast<std::size_t>(random.bits() % kAxes.size())];
  return random.chance(0.5) ? axis : Point2{axis.x, -axis.y};
}

/// Towers and a park near the centre, villas outside, blocks between.
QuarterKind quarter_kind(std::size_t rank, std::size_t quarters, SeededRandom& random) {
  const double share = (static_cast<double>(rank) + 0.5) / static_cast<double>(quarters);
  const double draw = random.unit();
  if (rank == 2) return QuarterKind::kPark;
  if (rank == 4) return QuarterKind::kModern;
  if (share > 0.7 || (share > 0.5 && draw > 0.75)) return QuarterKind::kVillas;
  if (rank > 6 && draw < 0.06) return QuarterKind::kPark;
  if (rank > 6 && draw < 0.18) return QuarterKind::kModern;
  return QuarterKind::kPerimeter;
}

struct BlockSize {
  double along;
  double across;
  double street_low;
  double street_high;
};

BlockSize block_size(QuarterKind kind) {
  switch (kind) {
    case QuarterKind::kModern:
      return {105, 95, 12, 16};
    case QuarterKind::kVillas:
      return {120, 48, 7, 9};
    case QuarterKind::kPark:
    case QuarterKind::kPerimeter:
      break;
  }
  return {88, 70, 9, 15};
}

/// Cuts a quarter into blocks by streets across its longer side, again and again.
void split(const Ring& ring, const Quarter& quarter, SeededRandom& random,
           std::vector<Block>& blocks) {
  if (ring.empty() || area({ring, {}}) < 120) return;
  const BlockSize size = block_size(quarter.kind);
  const auto extent = [&](Point2 direction) {
    double low = dot(direction, ring[0]);
    double high = low;
    for (const Point2 p : ring) {
      low = std::min(low, dot(direction, p));
      high = std::max(high, dot(direction, p));
    }
    return Point2{low, high};
  };
  const Point2 along = extent(quarter.axis);
  const Point2 across = extent(left_of(quarter.axis));
  const double pieces_along = (along.y - along.x) / size.along;
  const double pieces_across = (across.y - across.x) / size.across;
  const double pieces = std::max(pieces_along, pieces_across);
  if (pieces < 1.25) {
    blocks.push_back({ring, quarter.axis, quarter.kind});
    return;
  }
  const bool cut_along = pieces_along > pieces_across;
  const Point2 direction = cut_along ? quarter.axis : left_of(quarter.axis);
  const Point2 range = cut_along ? along : across;
  const double n = std::max(2.0, std::nearbyint(pieces));
  const double share = std::floor(n / 2) / n + random.uniform(-0.2, 0.2) / n;
  const double half_street = random.uniform(size.street_low, size.street_high) / 2;
  const double tilt = quarter.kind == QuarterKind::kPerimeter ? random.uniform(-0.05, 0.05) : 0;
  const Point2 normal = unit(direction + tilt * left_of(direction));
  Point2 middle{0, 0};
  for (const Point2 p : ring) middle = middle + (1.0 / static_cast<double>(ring.size())) * p;
  const double at = range.x + share * (range.y - range.x);
  const Point2 through = middle + (at - dot(direction, middle)) * direction;
  split(clip(ring, through + half_street * normal, normal), quarter, random, blocks);
  split(clip(ring, through - half_street * normal, -1.0 * normal), quarter, random, blocks);
}

}  // namespace

StreetPlan plan_streets(const BlockCityOptions& options) {
  SeededRandom random(options.seed, kPlanStream);
  const Grid grid = seed_grid(options.size);
  StreetPlan plan;
  plan.terrain = make_terrain(options, grid, random);
  const std::vector<Point2> seeds = quarter_seeds(grid, random);
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    const Ring ring = quarter_ring(seeds, s, grid, options);
    if (ring.empty()) continue;
    for (const double side : {1.0, -1.0}) {
      const Ring part = beside_river(ring, plan.terrain, side);
      if (area({part, {}}) < kSmallestQuarter) continue;
      plan.quarters.push_back({part, random_axis(random), QuarterKind::kPerimeter});
    }
  }
  const Point2 centre{0.5 * options.size, 0.55 * options.size};
  const auto remoteness = [&](const Quarter& quarter) {
    const Point2 d = interior_point({quarter.ring, {}}) - centre;
    return dot(d, d);
  };
  std::stable_sort(
      plan.quarters.begin(), plan.quarters.end(),
      [&](const Quarter& a, const Quarter& b) { return remoteness(a) < remoteness(b); });
  for (std::size_t q = 0; q < plan.quarters.size(); ++q) {
    Quarter& quarter = plan.quarters[q];
    quarter.kind = quarter_kind(q, plan.quarters.size(), random);
    if (quarter.kind == QuarterKind::kPark) {
      plan.blocks.push_back({quarter.ring, quarter.axis, quarter.kind});
    } else {
      split(quarter.ring, quarter, random, plan.blocks);
    }
  }
  for (std::int64_t i = 1; i<grid.n; i += grid.n> 4 ? 2 : 1)
    plan.crossings.push_back(static_cast<double>(i) * grid.spacing);
  return plan;
}

}  // namespace tetropolis
