#include "tetropolis/synth/synthetic_city.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/extract.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/dtm.h"

#include "city/part_tiling.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

/// FNV-1a over everything a city consists of.
class Fingerprint {
 public:
  explicit Fingerprint(const SyntheticCity& city) {
    for (const Polygon& footprint : city.footprints)
      for_each_edge(footprint, [&](Point2 a, Point2 b) { add(std::array{a.x, a.y, b.x, b.y}); });
    for (const std::string& id : city.ids) bytes(id.data(), id.size());
    add(city.ground);
    add(city.heights);
    for (const auto* values : {&city.points.x, &city.points.y, &city.points.z})
      add(std::vector<double>(values->begin(), values->end()));
    add(city.points.classification);
  }
  std::uint64_t value() const { return value_; }

 private:
  template <typename Array>
  void add(const Array& array) {
    bytes(array.data(), array.size() * sizeof(array[0]));
  }
  void bytes(const void* data, std::size_t size) {
    const auto* begin = static_cast<const unsigned char*>(data);
    for (std::size_t k = 0; k < size; ++k) value_ = (value_ ^ begin[k]) * 0x100000001b3ULL;
  }
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

std::uint64_t fingerprint(const SyntheticCity& city) { return Fingerprint(city).value(); }

std::map<int, std::int64_t> count_classes(const PointCloud& cloud) {
  std::map<int, std::int64_t> counts;
  for (const std::uint8_t code : cloud.classification) ++counts[code];
  return counts;
}

bool is_whole_mm(double value) { return std::nearbyint(value * 1000) / 1000 == value; }

Point2 centre_of(const Polygon& footprint) {
  const Bounds2 box = bounds(footprint);
  return {(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2};
}

/// What holds for every synthetic city.
void expect_sound(const SyntheticCity& city, double size, double margin) {
  EXPECT_EQ(city.domain, (Bounds2{0, 0, size, size}));
  ASSERT_EQ(city.ids.size(), city.footprints.size());
  ASSERT_EQ(city.ground.size(), city.footprints.size());
  ASSERT_EQ(city.heights.size(), city.footprints.size());
  EXPECT_EQ(std::set<std::string>(city.ids.begin(), city.ids.end()).size(), city.ids.size());
  EXPECT_EQ(city.counts.buildings, static_cast<std::int64_t>(city.footprints.size()));
  EXPECT_EQ(city.counts.buildings, city.counts.scattered + city.counts.row_houses +
                                       city.counts.courtyards + city.counts.towers +
                                       city.counts.houses + city.counts.sheds);
  for (std::size_t b = 0; b < city.footprints.size(); ++b) {
    const Polygon& footprint = city.footprints[b];
    const Bounds2 box = bounds(footprint);
    EXPECT_GE(std::min(box.xmin, box.ymin), margin - 1e-6) << b;
    EXPECT_LE(std::max(box.xmax, box.ymax), size - margin + 1e-6) << b;
    EXPECT_GT(signed_area(footprint.outer), 0) << b;
    for (const Ring& hole : footprint.holes) EXPECT_LT(signed_area(hole), 0) << b;
    EXPECT_GT(city.heights[b], 0);
    for_each_edge(footprint, [&](Point2 a, Point2) {
      EXPECT_TRUE(is_whole_mm(a.x) && is_whole_mm(a.y)) << b << ": " << a.x << " " << a.y;
    });
  }
  ASSERT_EQ(city.points.y.size(), city.points.size());
  ASSERT_EQ(city.points.z.size(), city.points.size());
  ASSERT_EQ(city.points.classification.size(), city.points.size());
  std::size_t odd = 0;
  for (std::size_t p = 0; p < city.points.size(); ++p)
    odd += city.domain.contains({city.points.x[p], city.points.y[p]}) &&
                   is_whole_mm(city.points.x[p]) && is_whole_mm(city.points.y[p]) &&
                   is_whole_mm(city.points.z[p])
               ? 0U
               : 1U;
  EXPECT_EQ(odd, 0U);
}

/// No ground or water under roofs, and no roof without a footprint.
void expect_points_match_footprints(const SyntheticCity& city) {
  const BuildingPoints found = extract_building_points(city.footprints, city.points, {0, 1e9});
  std::vector<bool> covered(city.points.size(), false);
  for (const PointIndex p : found.roof.values) covered[p] = true;
  PointCloud ground = city.points;  // Ground and water as class 6, to look for them under roofs.
  std::size_t bare_roofs = 0;
  for (std::size_t p = 0; p < city.points.size(); ++p) {
    const int code = city.points.classification[p];
    if (code == kBuildingClass && !covered[p]) ++bare_roofs;
    ground.classification[p] = code == kGround || code == kWater ? kBuildingClass : kUnclassified;
  }
  EXPECT_EQ(bare_roofs, 0U);
  EXPECT_TRUE(extract_building_points(city.footprints, ground, {0, 1e9}).roof.values.empty());
}

/// The DTM of the cloud is the terrain, and heights from it are the heights it was made of.
void expect_heights_come_back(const SyntheticCity& city, double tolerance) {
  const Raster dtm = build_dtm(city.points, city.domain, {2.0, {2, 9}});
  const BuildingPoints points = extract_building_points(city.footprints, city.points);
  std::vector<Building> buildings(city.footprints.size());
  for (std::size_t b = 0; b < buildings.size(); ++b) buildings[b].footprint = city.footprints[b];
  compute_heights(buildings, points, city.points, dtm);
  std::vector<double> misses;
  for (std::size_t b = 0; b < buildings.size(); ++b)
    if (buildings[b].n_roof_points >= 20)
      misses.push_back(std::abs(buildings[b].h_roof - city.ground[b] - city.heights[b]));
  ASSERT_GT(misses.size(), buildings.size() / 4);
  EXPECT_LT(percentile(misses, 90), tolerance);
  for (std::size_t p = 0; p < city.points.size(); p += 101) {
    if (city.points.classification[p] != kGround) continue;
    EXPECT_NEAR(city.points.z[p],
                synthetic_ground(city.terrain, city.points.x[p], city.points.y[p]), 0.08);
  }
}

TEST(SyntheticRandom, IsWhatTheOptionsSay) {
  RandomCityOptions options;
  options.buildings = 700;
  options.size = 600;
  options.points_per_m2 = 2;
  const SyntheticCity city = synthetic_random_city(options);
  expect_sound(city, options.size, options.margin);
  EXPECT_EQ(city.counts.scattered, 700);
  double narrowest = 1e9;
  double widest = 0;
  for (const Polygon& footprint : city.footprints) {
    ASSERT_EQ(footprint.outer.size(), 4U);
    const Bounds2 box = bounds(footprint);
    EXPECT_NEAR(box.width() * box.height(), area(footprint), 1e-6) << "axis-aligned";
    for (const double side : {box.width(), box.height()}) {
      EXPECT_GE(side, 1 - 1e-9);
      EXPECT_LE(side, 20 + 1e-9);
      narrowest = std::min(narrowest, side);
      widest = std::max(widest, side);
    }
  }
  EXPECT_LT(narrowest, 1.2);
  EXPECT_GT(widest, 19.8);
  const auto [low, high] = std::minmax_element(city.heights.begin(), city.heights.end());
  EXPECT_GE(*low, 12.5);
  EXPECT_LE(*high, 50);
  EXPECT_GT(*high - *low, 36);
  const auto classes = count_classes(city.points);
  EXPECT_EQ(classes.size(), 2U);
  EXPECT_GT(classes.at(kGround), 100000);
  EXPECT_NEAR(static_cast<double>(city.points.size()), 2 * 600 * 600, 2000);
  expect_points_match_footprints(city);
}

TEST(SyntheticRandom, CentresKeepTheirDistanceAndManyOverlap) {
  RandomCityOptions options;
  options.buildings = 1500;
  options.size = 500;
  options.points_per_m2 = 0;
  const SyntheticCity city = synthetic_random_city(options);
  EXPECT_EQ(city.points.size(), 0U);
  double nearest = 1e9;
  int overlaps = 0;
  for (std::size_t a = 0; a < city.footprints.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Point2 p = centre_of(city.footprints[a]);
      const Point2 q = centre_of(city.footprints[b]);
      nearest = std::min(nearest, std::hypot(p.x - q.x, p.y - q.y));
      if (bounds(city.footprints[a]).intersects(bounds(city.footprints[b]))) ++overlaps;
    }
  EXPECT_GE(nearest, 2 - 1e-9);
  EXPECT_LT(nearest, 2.2);
  EXPECT_GT(overlaps, 1000);
}

TEST(SyntheticRandom, HoldsTheBenchmarkCities) {
  RandomCityOptions options;
  options.points_per_m2 = 0;
  for (const std::int64_t buildings : {11585, 20000}) {
    options.buildings = buildings;
    EXPECT_EQ(synthetic_random_city(options).counts.scattered, buildings);
  }
}

TEST(SyntheticRandom, RefusesWhatDoesNotFit) {
  RandomCityOptions options;
  options.size = 150;
  options.buildings = 5000;
  EXPECT_THROW(synthetic_random_city(options), Error);
  options.buildings = 10;
  options.size = 90;
  EXPECT_THROW(synthetic_random_city(options), Error);
  options.size = 150;
  options.points_per_m2 = -1;
  EXPECT_THROW(synthetic_random_city(options), Error);
}

TEST(SyntheticRandom, FlatOrRolling) {
  RandomCityOptions options;
  options.size = 1000;
  options.buildings = 0;
  options.points_per_m2 = 0;
  for (const double relief : {0.0, 15.0}) {
    options.relief = relief;
    const SyntheticCity city = synthetic_random_city(options);
    double low = 1e9;
    double high = -1e9;
    for (double y = 0; y <= 1000; y += 10)
      for (double x = 0; x <= 1000; x += 10) {
        const double z = synthetic_ground(city.terrain, x, y);
        low = std::min(low, z);
        high = std::max(high, z);
        EXPECT_NEAR(synthetic_ground(city.terrain, x + 1, y), z, 0.15) << "gentle slopes";
      }
    EXPECT_LE(high - low, relief);
    EXPECT_GE(high - low, relief / 2);
  }
}

TEST(SyntheticRandom, HeightsComeBack) {
  RandomCityOptions options;
  options.buildings = 60;
  options.size = 600;
  options.points_per_m2 = 2;
  expect_heights_come_back(synthetic_random_city(options), 0.2);
}

TEST(SyntheticBlocks, HasEverythingACityNeeds) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE("city of seed " + std::to_string(seed));
    BlockCityOptions options;
    options.seed = seed;
    const SyntheticCity city = synthetic_block_city(options);
    expect_sound(city, options.size, options.margin - 0.05);
    EXPECT_GT(city.counts.row_houses, 100);
    EXPECT_GE(city.counts.courtyards, 1);
    EXPECT_GE(city.counts.towers, 3);
    EXPECT_GE(city.counts.houses, 30);
    EXPECT_GE(city.counts.sheds, 15);
    EXPECT_GT(city.counts.trees, 400);
    EXPECT_GT(city.counts.shifted, 3);
    const auto holes = std::count_if(city.footprints.begin(), city.footprints.end(),
                                     [](const Polygon& p) { return !p.holes.empty(); });
    EXPECT_EQ(holes, city.counts.courtyards);
    const auto classes = count_classes(city.points);
    for (const int code : {1, 2, 3, 4, 5, 6, 7, 9, 18}) EXPECT_TRUE(classes.count(code)) << code;
    EXPECT_EQ(classes.size(), 9U);
    // Water swallows pulses; everything else returns one point per cell.
    EXPECT_NEAR(static_cast<double>(city.points.size()), 3 * 500 * 500, 3 * 500 * 500 * 0.06);
  }
}

TEST(SyntheticBlocks, TidyPointsMatchFootprintsAndHeightsComeBack) {
  BlockCityOptions options;
  options.untidy = false;
  const SyntheticCity city = synthetic_block_city(options);
  EXPECT_EQ(city.counts.shifted + city.counts.extra_vertices, 0);
  expect_points_match_footprints(city);
  expect_heights_come_back(city, 0.3);
}

/// Whether segments a-b and c-d cross with the ends of each at least `depth` beyond the other's
/// line.
bool cross_deeply(Point2 a, Point2 b, Point2 c, Point2 d, double depth) {
  const auto side = [](Point2 o, Point2 p, Point2 q) {
    return ((p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x)) /
           std::hypot(p.x - o.x, p.y - o.y);
  };
  const double c_side = side(a, b, c);
  const double d_side = side(a, b, d);
  const double a_side = side(c, d, a);
  const double b_side = side(c, d, b);
  return std::min({std::abs(a_side), std::abs(b_side), std::abs(c_side), std::abs(d_side)}) >
             depth &&
         (c_side > 0) != (d_side > 0) && (a_side > 0) != (b_side > 0);
}

TEST(SyntheticBlocks, TidyBuildingsDoNotOverlapAndAreSimple) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}) {
    BlockCityOptions options;
    options.seed = seed;
    options.untidy = false;
    options.points_per_m2 = 0;
    options.size = seed == 6 ? 1000 : 500;
    const SyntheticCity city = synthetic_block_city(options);
    for (std::size_t a = 0; a < city.footprints.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        if (!bounds(city.footprints[a]).intersects(bounds(city.footprints[b]))) continue;
        // Party walls of two buildings may differ by the rounding to millimetres.
        bool crossing = false;
        for_each_edge(city.footprints[a], [&](Point2 p, Point2 q) {
          for_each_edge(city.footprints[b],
                        [&](Point2 r, Point2 s) { crossing |= cross_deeply(p, q, r, s, 0.002); });
        });
        EXPECT_FALSE(crossing) << "seed " << seed << ", buildings " << a << " and " << b;
        if (a == b) continue;
        EXPECT_FALSE(contains(city.footprints[a], interior_point(city.footprints[b])) ||
                     contains(city.footprints[b], interior_point(city.footprints[a])))
            << "seed " << seed << ", buildings " << a << " and " << b;
      }
  }
}

TEST(SyntheticBlocks, PartyWallsAreSharedVertexByVertex) {
  BlockCityOptions options;
  options.untidy = false;
  options.points_per_m2 = 0;
  const SyntheticCity city = synthetic_block_city(options);
  using Edge = std::pair<std::pair<double, double>, std::pair<double, double>>;
  std::map<Edge, std::size_t> owner;
  for (std::size_t b = 0; b < city.footprints.size(); ++b)
    for_each_edge(city.footprints[b], [&](Point2 p, Point2 q) {
      EXPECT_TRUE(owner.insert({{{p.x, p.y}, {q.x, q.y}}, b}).second)
          << "two buildings on one side";
    });
  int shared = 0;
  int equally_high = 0;
  std::set<std::size_t> with_neighbour;
  for (const auto& [edge, b] : owner) {
    const auto twin = owner.find({edge.second, edge.first});
    if (twin == owner.end()) continue;
    ++shared;
    with_neighbour.insert(b);
    if (city.heights[b] == city.heights[twin->second]) ++equally_high;
  }
  EXPECT_GT(shared, 250);
  EXPECT_GT(with_neighbour.size(), 150U);
  EXPECT_LT(equally_high, shared / 50);
  // No vertex lies on somebody else's wall without being its vertex: nothing nearly touches.
  for (std::size_t a = 0; a < city.footprints.size(); ++a)
    for (std::size_t b = 0; b < city.footprints.size(); ++b) {
      if (a == b || !bounds(city.footprints[a]).grown(0.3).intersects(bounds(city.footprints[b])))
        continue;
      for_each_edge(city.footprints[a], [&](Point2 p, Point2) {
        const double distance = distance_to_boundary(city.footprints[b], p);
        const Ring& ring = city.footprints[b].outer;
        const bool vertex = std::find(ring.begin(), ring.end(), p) != ring.end();
        EXPECT_TRUE(vertex || distance > 0.3)
            << "buildings " << a << " and " << b << " at " << p.x << " " << p.y << ": " << distance;
      });
    }
}

TEST(SyntheticBlocks, RiverIsLowAndFreeOfBuildings) {
  BlockCityOptions options;
  const SyntheticCity city = synthetic_block_city(options);
  const SyntheticTerrain& terrain = city.terrain;
  ASSERT_TRUE(terrain.river);
  for (std::size_t p = 0; p < city.points.size(); ++p) {
    if (city.points.classification[p] != kWater) continue;
    EXPECT_LE(synthetic_river_distance(terrain, city.points.x[p], city.points.y[p]),
              terrain.river_half_width);
    EXPECT_NEAR(city.points.z[p], terrain.water_level, 0.07);
  }
  for (const Polygon& footprint : city.footprints)
    for_each_edge(footprint, [&](Point2 a, Point2 b) {
      for (int k = 0; k < 10; ++k)
        EXPECT_GT(synthetic_river_distance(terrain, a.x + (b.x - a.x) * k / 10,
                                           a.y + (b.y - a.y) * k / 10),
                  terrain.river_half_width + 3);
    });
  // The hills around it.
  double highest = 0;
  for (double y = 0; y <= 500; y += 5)
    for (double x = 0; x <= 500; x += 5) {
      const double z = synthetic_ground(terrain, x, y);
      highest = std::max(highest, z);
      if (synthetic_river_distance(terrain, x, y) > terrain.river_half_width + 2) {
        EXPECT_GE(z, terrain.base - 1e-9);
      }
    }
  EXPECT_GT(highest, terrain.base + options.relief / 2);
}

TEST(SyntheticBlocks, CountCanBeAskedFor) {
  BlockCityOptions options;
  options.size = 800;
  options.points_per_m2 = 0;
  const std::int64_t usual = synthetic_block_city(options).counts.buildings;
  for (const double share : {0.7, 1.2}) {
    options.buildings = static_cast<std::int64_t>(share * static_cast<double>(usual));
    const double count = static_cast<double>(synthetic_block_city(options).counts.buildings);
    EXPECT_NEAR(count / static_cast<double>(options.buildings), 1, 0.08);
  }
}

TEST(SyntheticBlocks, UntidyFootprintsAreNearTheTidyOnes) {
  BlockCityOptions options;
  options.points_per_m2 = 0;
  const SyntheticCity untidy = synthetic_block_city(options);
  options.untidy = false;
  const SyntheticCity tidy = synthetic_block_city(options);
  ASSERT_EQ(tidy.footprints.size(), untidy.footprints.size());
  std::int64_t moved = 0;
  std::int64_t longer = 0;
  for (std::size_t b = 0; b < tidy.footprints.size(); ++b) {
    const Bounds2 p = bounds(tidy.footprints[b]);
    const Bounds2 q = bounds(untidy.footprints[b]);
    EXPECT_LE(std::max(std::abs(p.xmin - q.xmin), std::abs(p.ymax - q.ymax)), 0.0511) << b;
    if (untidy.footprints[b].outer.size() > tidy.footprints[b].outer.size()) {
      ++longer;
    } else if (!(untidy.footprints[b] == tidy.footprints[b])) {
      ++moved;
    }
  }
  EXPECT_EQ(longer, untidy.counts.extra_vertices);
  EXPECT_EQ(moved, untidy.counts.shifted);
  EXPECT_GT(longer, 0);
}

TEST(SyntheticBlocks, RefusesNonsense) {
  BlockCityOptions options;
  options.size = 100;
  EXPECT_THROW(synthetic_block_city(options), Error);
  options.size = 500;
  options.margin = 200;
  EXPECT_THROW(synthetic_block_city(options), Error);
  options.margin = 20;
  options.relief = -1;
  EXPECT_THROW(synthetic_block_city(options), Error);
}

/// What the laser sees of sloped roofs is where the truth says, whose parts tile footprints that
/// are those of the city with level roofs.
TEST(SyntheticBlocks, SlopedRoofsAreWhereTheTruthSays) {
  BlockCityOptions options;
  options.untidy = false;
  const SyntheticCity level = synthetic_block_city(options);
  EXPECT_TRUE(level.truth.buildings.empty());
  options.sloped_roofs = true;
  const SyntheticCity city = synthetic_block_city(options);
  ASSERT_EQ(city.truth.buildings.size(), city.footprints.size());
  EXPECT_EQ(city.footprints, level.footprints);
  std::map<std::string, int> kinds;
  for (std::size_t b = 0; b < city.footprints.size(); ++b) {
    const Building& building = city.truth.buildings[b];
    EXPECT_EQ(building.source_ids, std::vector{city.ids[b]});
    EXPECT_NEAR(area(building.footprint), area(city.footprints[b]), 0.2);
    if (building.parts.empty()) continue;
    EXPECT_EQ(tiling_fault(building.footprint, building.parts), "");
    ++kinds["sloped"];
    if (building.parts.size() == 1) ++kinds["shed"];
    if (building.parts.size() == 2) ++kinds["two"];
    if (building.parts.size() >= 4) ++kinds["many"];
    for (const RoofPart& part : building.parts) {
      EXPECT_EQ(part.roof, snap_plane(part.roof));
      if (!part.outline.holes.empty()) ++kinds["island"];
      for (const Point2& p : part.outline.outer) EXPECT_GT(part.roof(p), building.h_ground + 1);
    }
  }
  EXPECT_GT(kinds["sloped"], 150);
  for (const char* kind : {"shed", "two", "many", "island"}) EXPECT_GT(kinds[kind], 15) << kind;
  // Brute force, for some buildings: every point of class 6 well inside a part is on its plane but
  // for noise and chimneys.
  std::int64_t seen = 0, off = 0;
  for (std::size_t b = 0; b < 60; ++b)
    for (const RoofPart& part : city.truth.buildings[b].parts) {
      const Bounds2 box = bounds(part.outline);
      for (std::size_t i = 0; i < city.points.size(); ++i) {
        const Point2 p{city.points.x[i], city.points.y[i]};
        if (!box.contains(p) || city.points.classification[i] != kBuildingClass ||
            !contains(part.outline, p) || distance_to_boundary(part.outline, p) < 0.02)
          continue;
        ++seen;
        if (std::abs(city.points.z[i] - part.roof(p)) > 0.12) ++off;
      }
    }
  EXPECT_GT(seen, 10000);
  EXPECT_LT(off, seen / 50);
}

TEST(Synthetic, SameSeedSameBytesOtherSeedOtherBytes) {
  BlockCityOptions blocks;
  blocks.points_per_m2 = 1;
  const std::uint64_t first = fingerprint(synthetic_block_city(blocks));
  RandomCityOptions random;
  random.size = 400;
  random.buildings = 200;
  const std::uint64_t second = fingerprint(synthetic_random_city(random));
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(fingerprint(synthetic_block_city(blocks)), first);
    EXPECT_EQ(fingerprint(synthetic_random_city(random)), second);
  }
  blocks.seed = random.seed = 7;
  EXPECT_NE(fingerprint(synthetic_block_city(blocks)), first);
  EXPECT_NE(fingerprint(synthetic_random_city(random)), second);
}

TEST(Synthetic, BytesAreTheSameOnEveryPlatform) {
  // Recorded once. If a change to the generator is meant to change cities, record them again.
  BlockCityOptions blocks;
  blocks.points_per_m2 = 1;
  EXPECT_EQ(fingerprint(synthetic_block_city(blocks)), 11885641198163699460ULL);
  RandomCityOptions random;
  random.size = 400;
  random.buildings = 200;
  EXPECT_EQ(fingerprint(synthetic_random_city(random)), 310957673963615660ULL);
}

TEST(Synthetic, CanBeStopped) {
  BlockCityOptions options;
  EXPECT_THROW(synthetic_block_city(options, {{}, [] { return true; }}), Cancelled);
}

}  // namespace
}  // namespace tetropolis
