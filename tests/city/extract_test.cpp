#include "tetropolis/city/extract.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "support/indices.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::indices_of;
using testing::test_seed;

struct ScannedFootprints {
  std::vector<Polygon> footprints;
  PointCloud cloud;
};

/// Overlapping stars of all sizes, some with courtyards, in a cloud of the given classes that is
/// wider than the footprints.
ScannedFootprints random_scene(int footprints, int points,
                               const std::vector<std::uint8_t>& classes) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> coordinate(-100, 100);
  ScannedFootprints scene;
  for (int k = 0; k < footprints; ++k) {
    const Point2 centre{coordinate(random), coordinate(random)};
    const double size = k % 10 == 0 ? 60 : 6;
    Polygon footprint{
        testing::random_star(random, centre, k % 7 == 0 ? 300 : 4 + k % 9, 0.6 * size, size), {}};
    if (k % 3 == 0)
      footprint.holes.push_back(testing::random_star(random, centre, 5, 0.2 * size, 0.5 * size));
    scene.footprints.push_back(footprint);
  }
  std::uniform_real_distribution<double> wide(-180, 180);
  for (int k = 0; k < points; ++k)
    scene.cloud.push_back(wide(random), wide(random), wide(random),
                          classes[random() % classes.size()]);
  return scene;
}

std::vector<PointIndex> to_vector(std::span<const PointIndex> list) {
  return {list.begin(), list.end()};
}

std::ptrdiff_t count_by_exclusion(const BuildingPoints& points) {
  return std::count(points.by_exclusion.begin(), points.by_exclusion.end(), 1);
}

/// The definition, point by point.
std::vector<PointIndex> brute_force(const ScannedFootprints& scene, std::size_t footprint,
                                    bool roof, double margin, const std::set<int>& classes) {
  std::vector<PointIndex> list;
  const Polygon& polygon = scene.footprints[footprint];
  for (std::size_t p = 0; p < scene.cloud.size(); ++p) {
    const Point2 at{scene.cloud.x[p], scene.cloud.y[p]};
    if (classes.count(scene.cloud.classification[p]) == 0) continue;
    const bool inside = contains(polygon, at);
    if (roof ? inside : !inside && distance_to_boundary(polygon, at) <= margin)
      list.push_back(static_cast<PointIndex>(p));
  }
  return list;
}

TEST(Extract, AgreesWithBruteForce) {
  const ScannedFootprints scene = random_scene(120, 20000, {1, 2, 5, 6, 6, 9, 26});
  for (const double margin : {0.0, 1.0, 7.5}) {
    const BuildingPoints points =
        extract_building_points(scene.footprints, scene.cloud, {margin, kInfinity});
    EXPECT_EQ(count_by_exclusion(points), 0);
    ASSERT_EQ(points.roof.size(), scene.footprints.size());
    ASSERT_EQ(points.ground.size(), scene.footprints.size());
    std::size_t roof_points = 0;
    for (std::size_t f = 0; f < scene.footprints.size(); ++f) {
      EXPECT_EQ(to_vector(points.roof[f]), brute_force(scene, f, true, margin, {6}))
          << "footprint " << f << " seed " << test_seed();
      EXPECT_EQ(to_vector(points.ground[f]), brute_force(scene, f, false, margin, {2, 9}))
          << "footprint " << f << " margin " << margin << " seed " << test_seed();
      roof_points += points.roof[f].size();
    }
    EXPECT_GT(roof_points, 2500U);
  }
}

TEST(Extract, WithoutClassSixTakesWhatNoOtherClassSaysIsNoRoof) {
  const ScannedFootprints scene =
      random_scene(40, 20000, {0, 1, 2, 3, 4, 5, 7, 8, 9, 14, 17, 18, 26});
  const BuildingPoints points =
      extract_building_points(scene.footprints, scene.cloud, {1, kInfinity, false});
  EXPECT_EQ(count_by_exclusion(points), 40);
  bool some_low = false, some_mostly_low = false;
  for (std::size_t f = 0; f < scene.footprints.size(); ++f) {
    const std::vector<PointIndex> all = brute_force(scene, f, true, 1, {0, 1, 26});
    std::vector<double> ground;
    for (const PointIndex p : brute_force(scene, f, false, 1, {2, 9}))
      ground.push_back(scene.cloud.z[p]);
    std::sort(ground.begin(), ground.end());
    double low = -kInfinity;
    if (!ground.empty()) {
      const double q = 0.1 * static_cast<double>(ground.size() - 1);
      const auto k = static_cast<std::size_t>(q);
      low = ground[k];
      if (k + 1 < ground.size()) low += (q - std::floor(q)) * (ground[k + 1] - ground[k]);
    }
    std::vector<PointIndex> expected;
    for (const PointIndex p : all)
      if (scene.cloud.z[p] > low + 0.5) expected.push_back(p);
    const bool mostly_low = 2 * expected.size() < all.size();
    some_low = some_low || (!mostly_low && expected.size() < all.size());
    some_mostly_low = some_mostly_low || mostly_low;
    EXPECT_EQ(to_vector(points.roof[f]), mostly_low ? all : expected)
        << "footprint " << f << " seed " << test_seed();
  }
  EXPECT_TRUE(some_low && some_mostly_low) << test_seed();
}

/// A house beside a wide tower, trees around it, and a few points of the tower's wall on its roof.
/// What the tower hides is known from its footprint, whether it is a building of the model or not.
TEST(Extract, TheWallOfANeighbourIsNoCrown) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> share(0, 1);
  const Polygon house{{{0, 0}, {10, 0}, {10, 8}, {0, 8}}, {}};
  const Polygon tower{{{10, 0}, {30, 0}, {30, 8}, {10, 8}}, {}};
  PointCloud cloud;
  for (int k = 0; k < 400; ++k) cloud.push_back(10 * share(random), 8 * share(random), 6, 1);
  for (int k = 0; k < 2500; ++k) cloud.push_back(10 + 20 * share(random), 8 * share(random), 20, 1);
  for (int k = 0; k < 200; ++k)
    cloud.push_back(-3 + 2 * share(random), 8 * share(random), 20 * share(random), 1);
  const std::size_t first = cloud.size();
  for (int k = 0; k < 30; ++k)
    cloud.push_back(10 - 0.1 * share(random), 8 * share(random), 6 + 13 * share(random), 1);
  const auto walls_kept = [&](const BuildingPoints& points) {
    return std::count_if(points.roof[0].begin(), points.roof[0].end(),
                         [&](PointIndex p) { return p >= first; });
  };
  std::vector<Building> alone(1), both(2);
  alone[0].footprint = both[0].footprint = house;
  both[1].footprint = tower;
  const ExtractOptions options{1, kInfinity};
  EXPECT_GT(walls_kept(extract_building_points(both, {}, cloud, options)), 27) << test_seed();
  EXPECT_GT(walls_kept(extract_building_points(alone, std::vector{tower}, cloud, options)), 27)
      << test_seed();
  EXPECT_LT(walls_kept(extract_building_points(alone, {}, cloud, options)), 25)
      << "the tower passes for a tree where nothing is known of it; seed " << test_seed();
}

TEST(Extract, TheFloorOfAYardIsNoRoof) {
  ScannedFootprints scene{{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {}}}, {}};
  for (int k = 0; k < 10; ++k) scene.cloud.push_back(-0.5, k, 3, 2);  // 0 to 9
  scene.cloud.push_back(5, 5, 3.4, 1);                                // 10: in the yard,
  scene.cloud.push_back(6, 5, 1, 1);                                  // 11: sunken,
  for (int k = 0; k < 3; ++k) scene.cloud.push_back(2, k + 1, 8, 1);  // 12 to 14: the roof.
  EXPECT_EQ(to_vector(extract_building_points(scene.footprints, scene.cloud).roof[0]),
            (std::vector<PointIndex>{12, 13, 14}));
  // With class 6 the classes are believed.
  for (PointIndex p = 10; p < scene.cloud.size(); ++p) scene.cloud.classification[p] = 6;
  EXPECT_EQ(extract_building_points(scene.footprints, scene.cloud, {1, kInfinity}).roof[0].size(),
            5U);
}

TEST(Extract, OneClassSixPointAmongFewSettlesIt) {
  ScannedFootprints scene{{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {}}}, {}};
  scene.cloud.push_back(5, 5, 20, 1);
  EXPECT_EQ(extract_building_points(scene.footprints, scene.cloud).roof[0].size(), 1U);
  scene.cloud.push_back(500, 500, 20, 6);
  const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud);
  EXPECT_EQ(points.by_exclusion, std::vector<std::uint8_t>{0});
  EXPECT_TRUE(points.roof[0].empty());
}

TEST(Extract, AFewStrayPointsOfClassSixDoNot) {
  for (const int strays : {1, 7, 8}) {
    ScannedFootprints scene{{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {}}}, {}};
    for (int k = 0; k < 9000; ++k) scene.cloud.push_back(5, 5, 20, 1);
    for (int k = 0; k < strays; ++k) scene.cloud.push_back(500, 500, 20, 6);
    const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud);
    EXPECT_EQ(points.by_exclusion[0], strays < 8 ? 1 : 0) << strays;
    EXPECT_EQ(points.roof[0].size(), strays < 8 ? 9000U : 0U) << strays;
  }
}

TEST(Extract, WhatAgenciesKeepApartOfGroundAndWaterIsNoRoof) {
  ScannedFootprints scene{{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {}}}, {}};
  for (const std::uint8_t code : {2, 3, 5, 7, 8, 9, 10, 11, 13, 17, 18, 20, 40, 41, 45})
    scene.cloud.push_back(5, 5, 20, code);
  EXPECT_TRUE(extract_building_points(scene.footprints, scene.cloud).roof[0].empty());
  for (const std::uint8_t code : {0, 1, 12, 19, 21, 26, 39, 46, 255})
    scene.cloud.push_back(5, 5, 20, code);
  EXPECT_EQ(extract_building_points(scene.footprints, scene.cloud).roof[0].size(), 9U);
}

/// Two quarters; of the second nobody has told buildings from the rest but for a part of one house,
/// and another of its plots is empty.
TEST(Extract, RoofsInFilesWithoutTheClassAreByExclusion) {
  ScannedFootprints scene;
  ExtractOptions options;
  const auto house = [&](double x, double y, std::uint8_t code, int points, double z) {
    scene.footprints.push_back({{{x, y}, {x + 10, y}, {x + 10, y + 10}, {x, y + 10}}, {}});
    for (int k = 0; k < points; ++k) scene.cloud.push_back(x + 2 + k % 5, y + 2 + k / 5, z, code);
    for (int k = 0; k < 5; ++k) scene.cloud.push_back(x - 0.5, y + 2 * k, 0, 2);
  };
  for (int k = 0; k < 20; ++k) {
    const bool gone = k == 7;
    house(20 * (k % 5), 20 * (k / 5), gone ? 1 : 6, gone ? 3 : 25, gone ? 1.5 : 8);
  }
  const std::size_t seam = scene.cloud.size();
  for (int k = 0; k < 20; ++k) house(100 + 20 * (k % 5), 20 * (k / 5), 1, k == 3 ? 0 : 25, 9);
  options.no_buildings = {{seam, scene.cloud.size()}};
  for (int k = 0; k < 9; ++k)
    scene.cloud.push_back(102 + k, 1, 9, 6);  // of the first in the second
  const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud, options);
  for (std::size_t b = 0; b < 40; ++b) {
    const bool second = b >= 20, empty = b == 23;
    EXPECT_EQ(points.by_exclusion[b] != 0, second && !empty) << b;
    EXPECT_EQ(points.roof[b].size(), b == 7 || empty ? 0U : b == 20 ? 33U : 25U) << b;
    EXPECT_EQ(points.ground[b].size(), 5U) << b;
  }
  // Without a word on files, clean roofs are found one by one.
  const BuildingPoints by_building = extract_building_points(scene.footprints, scene.cloud);
  EXPECT_EQ(count_by_exclusion(by_building), 0);
  for (std::size_t b = 0; b < 40; ++b)
    EXPECT_EQ(by_building.by_exclusion[b], b > 20 && b != 23 ? 2 : 0) << b;
}

/// Beside classified houses: plots whose points have no class but those on the ground.
TEST(Extract, ACleanRoofWithoutTheClassIsARoof) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> within(0.1, 9.9), deep(2, 9), noise(-0.03, 0.03);
  ScannedFootprints scene;
  const auto plot = [&](const auto& height, int points, std::uint8_t code, int ground_inside) {
    const double x = 20.0 * static_cast<double>(scene.footprints.size());
    scene.footprints.push_back(testing::rectangle(x, 0, x + 10, 10));
    for (int k = 0; k < points; ++k) {
      const double u = within(random), v = within(random);
      scene.cloud.push_back(x + u, v, height(u, v) + noise(random), code);
    }
    for (int k = 0; k < ground_inside; ++k)
      scene.cloud.push_back(x + within(random), within(random), noise(random), kGround);
    for (int k = 0; k < 20; ++k) scene.cloud.push_back(x - 0.5, 0.5 * k, noise(random), kGround);
    return scene.footprints.size() - 1;
  };
  const auto gable = [](double, double v) { return 9 - 0.7 * std::abs(v - 5); };
  const auto level = [](double z) { return [z](double, double) { return z; }; };
  for (int k = 0; k < 10; ++k) plot(gable, 400, kBuildingClass, 0);
  const std::size_t house = plot(gable, 400, kUnclassified, 0);
  const std::size_t sparse = plot(level(6), 50, kUnclassified, 0);
  const std::size_t trees =
      plot([&](double, double) { return deep(random); }, 400, kUnclassified, 0);
  const std::size_t hedge = plot(level(1.3), 400, kUnclassified, 0);
  const std::size_t awning = plot(level(3), 150, kUnclassified, 300);
  const std::size_t few = plot(level(6), 8, kUnclassified, 0);
  for (const RoofPoints said : {RoofPoints::kAuto, RoofPoints::kClassified}) {
    ExtractOptions options;
    options.roof_points = said;
    const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud, options);
    for (const std::size_t b : {house, sparse}) {
      EXPECT_EQ(points.by_exclusion[b], 2) << b << " seed " << test_seed();
      EXPECT_GT(points.roof[b].size(), 40U);
      for (const PointIndex p : points.roof[b])
        EXPECT_EQ(scene.cloud.classification[p], kUnclassified);
    }
    for (const std::size_t b : {std::size_t{0}, trees, hedge, awning, few}) {
      EXPECT_EQ(points.by_exclusion[b], 0) << b << " seed " << test_seed();
      EXPECT_EQ(points.roof[b].empty(), b != 0) << b;
    }
  }
}

TEST(Extract, WithAWordOnClassesAFarPlaceChangesNothing) {
  const std::vector<Polygon> here{testing::rectangle(0, 0, 10, 10)};
  PointCloud cloud;
  for (double x = -0.75; x < 11; x += 0.5)
    for (double y = -0.75; y < 11; y += 0.5) {
      const bool inside = x > 0 && x < 10 && y > 0 && y < 10;
      cloud.push_back(x, y, inside ? 8 : 0, inside ? kUnclassified : kGround);
    }
  const PointCloud alone = cloud;
  for (int k = 0; k < 2000; ++k) cloud.push_back(5000 + k % 50, 5000 + k / 50, 9, kBuildingClass);
  for (const RoofPoints said : {RoofPoints::kClassified, RoofPoints::kExclusion}) {
    ExtractOptions options;
    options.roof_points = said;
    EXPECT_EQ(extract_building_points(here, alone, options),
              extract_building_points(here, cloud, options));
    EXPECT_EQ(extract_building_points(here, cloud, options).by_exclusion[0],
              said == RoofPoints::kClassified ? 2 : 1);
  }
  // Without, the far place decides.
  EXPECT_NE(extract_building_points(here, alone), extract_building_points(here, cloud));
}

TEST(Extract, CourtyardIsOutside) {
  ScannedFootprints scene{
      {{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}, {{{5, 5}, {5, 15}, {15, 15}, {15, 5}}}}}, {}};
  scene.cloud.push_back(10, 10, 20, 6);  // 0: a pavilion in the yard.
  scene.cloud.push_back(2, 2, 20, 6);    // 1: the roof.
  scene.cloud.push_back(5.5, 10, 1, 2);  // 2: in the yard, at the wall.
  scene.cloud.push_back(10, 10, 1, 2);   // 3: in the middle of the yard.
  scene.cloud.push_back(-1, 10, 1, 2);   // 4: outside, exactly at the margin.
  scene.cloud.push_back(-1.001, 10, 1, 2);
  scene.cloud.push_back(2, 2, 1, 2);  // Ground inside the footprint is neither.
  const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud);
  EXPECT_EQ(to_vector(points.roof[0]), (std::vector<PointIndex>{1}));
  EXPECT_EQ(to_vector(points.ground[0]), (std::vector<PointIndex>{2, 4}));
}

TEST(Extract, AdjoiningBuildingsShareNoRoofPoint) {
  ScannedFootprints scene;
  for (int k = 0; k < 10; ++k) {
    const double x = k * 7.3;
    scene.footprints.push_back({{{x, 0}, {x + 7.3, 3}, {x + 7.3, 15}, {x, 12}}, {}});
  }
  for (int k = 0; k < 10000; ++k)
    scene.cloud.push_back(73.0 * k / 10000, 4 + (k % 80) * 0.1, 10, 6);
  const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud);
  EXPECT_EQ(std::set<PointIndex>(points.roof.values.begin(), points.roof.values.end()).size(),
            points.roof.values.size());
}

TEST(Extract, SameForAnyNumberOfThreads) {
  const ScannedFootprints scene = random_scene(60, 150000, {1, 2, 6});
  BuildingPoints one;
  {
    const ThreadLimit limit(1);
    one = extract_building_points(scene.footprints, scene.cloud);
  }
  const ThreadLimit limit(4);
  EXPECT_EQ(extract_building_points(scene.footprints, scene.cloud), one);
}

TEST(Extract, BuildingsGiveWhatTheirFootprintsGive) {
  const ScannedFootprints scene = random_scene(20, 5000, {2, 6});
  std::vector<Building> buildings(scene.footprints.size());
  for (std::size_t b = 0; b < buildings.size(); ++b) buildings[b].footprint = scene.footprints[b];
  EXPECT_EQ(extract_building_points(std::span<const Building>(buildings), {}, scene.cloud),
            extract_building_points(scene.footprints, scene.cloud));
}

TEST(Extract, NothingFromNothing) {
  const ScannedFootprints scene = random_scene(3, 100, {2, 6});
  EXPECT_EQ(extract_building_points(std::vector<Polygon>{}, scene.cloud).roof.size(), 0U);
  const BuildingPoints points = extract_building_points(scene.footprints, PointCloud{});
  EXPECT_EQ(points.roof.size(), 3U);
  EXPECT_TRUE(points.roof.values.empty());
  EXPECT_EQ(count_by_exclusion(points), 3);
  const std::vector<Polygon> empty(2);
  EXPECT_TRUE(extract_building_points(empty, scene.cloud).ground.values.empty());
}

TEST(Extract, ManyHugeFootprintsKeepTheGridSmall) {
  // Thousands of footprints that all cover one large square would fill any fine grid many times.
  ScannedFootprints scene = random_scene(0, 100, {6});
  for (int k = 0; k < 3000; ++k) {
    const double half = 20000 + k;
    scene.footprints.push_back({{{-half, -half}, {half, -half}, {half, half}, {-half, half}}, {}});
  }
  const BuildingPoints points =
      extract_building_points(scene.footprints, scene.cloud, {1, kInfinity});
  EXPECT_EQ(points.roof.values.size(), 300000U);
}

TEST(Extract, CanBeStopped) {
  const ScannedFootprints scene = random_scene(3, 100, {2, 6});
  EXPECT_THROW(
      extract_building_points(scene.footprints, scene.cloud, {}, {{}, [] { return true; }}),
      Cancelled);
}

TEST(DropOutliers, AgreesWithTheDefinition) {
  std::mt19937 random(test_seed());
  std::normal_distribution<double> height(50, 3);
  PointCloud cloud;
  PointLists lists;
  for (int b = 0; b < 200; ++b) {
    for (int k = 0; k < b % 37; ++k) {
      lists.values.push_back(static_cast<PointIndex>(cloud.size()));
      cloud.push_back(0, 0, k % 11 == 0 ? 500 * height(random) : height(random), 6);
    }
    lists.offsets.push_back(static_cast<std::int64_t>(lists.values.size()));
  }
  for (const double sigma : {0.5, 2.0, kInfinity}) {
    PointLists filtered = lists;
    drop_outliers(filtered, cloud, sigma);
    ASSERT_EQ(filtered.size(), lists.size());
    for (std::size_t b = 0; b < lists.size(); ++b) {
      // E[z^2] - E[z]^2 in extended precision: another formula for the variance.
      long double sum = 0;
      long double squares = 0;
      for (const PointIndex p : lists[b]) {
        sum += static_cast<long double>(cloud.z[p]);
        squares += static_cast<long double>(cloud.z[p]) * static_cast<long double>(cloud.z[p]);
      }
      const auto n = static_cast<long double>(lists[b].size());
      const long double mean = n > 0 ? sum / n : 0;
      const long double deviation =
          n > 0 ? std::sqrt(std::max(squares / n - mean * mean, 0.0L)) : 0;
      std::vector<PointIndex> expected;
      for (const PointIndex p : lists[b])
        if (lists[b].size() == 1 || std::isinf(sigma) ||
            std::abs(static_cast<long double>(cloud.z[p]) - mean) <=
                static_cast<long double>(sigma) * deviation)
          expected.push_back(p);
      EXPECT_EQ(to_vector(filtered[b]), expected) << "list " << b << " seed " << test_seed();
    }
  }
}

TEST(DropOutliers, KeepsEqualHeights) {
  for (const double z : {0.1, 12.3, 1e5 / 3}) {
    PointCloud cloud;
    PointLists lists;
    for (int k = 0; k < 7; ++k) {
      cloud.push_back(0, 0, z, 6);
      lists.values.push_back(static_cast<PointIndex>(k));
    }
    lists.offsets.push_back(7);
    drop_outliers(lists, cloud, 2);
    EXPECT_EQ(lists.values.size(), 7U) << z;
  }
}

/// Four of five at one height put the fifth at exactly two standard deviations.
TEST(DropOutliers, KeepsWhatIsAtTheLimit) {
  for (int k = 0; k < 200; ++k) {
    PointCloud cloud;
    PointLists lists;
    for (int i = 0; i < 5; ++i) {
      cloud.push_back(0, 0, 0.01 * (i == k % 5 ? 700 + k : 431 + 3 * k), 6);
      lists.values.push_back(static_cast<PointIndex>(i));
    }
    lists.offsets.push_back(5);
    drop_outliers(lists, cloud, 2);
    EXPECT_EQ(lists.values.size(), 5U) << k;
  }
}

TEST(MergeBuildingPoints, IsTheUnionOfTheMembers) {
  const ScannedFootprints scene = random_scene(50, 20000, {2, 6});
  const BuildingPoints points = extract_building_points(scene.footprints, scene.cloud);
  std::vector<std::vector<BuildingIndex>> members{indices_of<BuildingIndex>({3}),
                                                  indices_of<BuildingIndex>({10, 0, 20}),
                                                  {},
                                                  indices_of<BuildingIndex>({5, 6, 7, 8, 9}),
                                                  indices_of<BuildingIndex>({3})};
  std::vector<BuildingIndex> all(scene.footprints.size());
  std::iota(all.begin(), all.end(), BuildingIndex(0));
  members.push_back(all);
  const BuildingPoints merged = merge_building_points(points, members);
  ASSERT_EQ(merged.roof.size(), members.size());
  ASSERT_EQ(merged.ground.size(), members.size());
  bool overlapped = false;
  for (std::size_t m = 0; m < members.size(); ++m) {
    std::set<PointIndex> roof;
    std::set<PointIndex> ground;
    std::size_t roof_total = 0;
    for (const BuildingIndex b : members[m]) {
      const auto building = static_cast<std::size_t>(b);
      roof.insert(points.roof[building].begin(), points.roof[building].end());
      ground.insert(points.ground[building].begin(), points.ground[building].end());
      roof_total += points.roof[building].size();
    }
    overlapped |= roof.size() < roof_total;
    EXPECT_EQ(to_vector(merged.roof[m]), std::vector<PointIndex>(roof.begin(), roof.end()));
    EXPECT_EQ(to_vector(merged.ground[m]), std::vector<PointIndex>(ground.begin(), ground.end()));
  }
  EXPECT_TRUE(overlapped) << "the case should have a point in two members";
}

}  // namespace
}  // namespace tetropolis
