#include "city/tree_crowns.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

/// One building, 10 m x 8 m on ground at 0, and what stands around it.
struct Scene {
  PointCloud cloud;
  PointLists roof, below, around, beside;

  void add(PointLists& list, double x, double y, double z) {
    list.values.push_back(static_cast<PointIndex>(cloud.size()));
    cloud.push_back(x, y, z, kUnclassified);
  }
  void close() {
    for (PointLists* list : {&roof, &below, &around, &beside})
      list->offsets = {0, static_cast<std::int64_t>(list->values.size())};
  }
};

class Crowns : public ::testing::Test {
 protected:
  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double noise() { return std::normal_distribution<double>(0, 0.03)(random_); }

  void scan_roof(const std::function<double(double, double)>& height, int points) {
    for (int k = 0; k < points; ++k) {
      const double x = 10 * share(), y = 8 * share();
      scene_.add(scene_.roof, x, y, height(x, y) + noise());
    }
  }
  /// A crown over part of the building, and beyond.
  void scan_tree(int points) {
    for (int k = 0; k < points; ++k)
      scene_.add(scene_.roof, 6 * share(), 8 * share(), 5 + 7 * share());
    for (int k = 0; k < points; ++k)
      scene_.add(scene_.around, -3 + 2 * share(), 8 * share(), 5 + 7 * share());
  }
  /// Trees beside the building, up to this height.
  void scan_trees_around(double top) {
    for (int k = 0; k < 200; ++k)
      scene_.add(scene_.around, -3 + 2 * share(), 8 * share(), 5 + (top - 5) * share());
  }
  std::vector<PointIndex> kept() {
    scene_.close();
    PointLists roof = scene_.roof;
    drop_tree_crowns(roof, {scene_.below, scene_.around, scene_.beside}, scene_.cloud);
    EXPECT_TRUE(std::is_sorted(roof.values.begin(), roof.values.end()));
    return roof.values;
  }
  /// How many of the points numbered [first, last) were kept.
  static std::ptrdiff_t among(const std::vector<PointIndex>& kept, PointIndex first,
                              PointIndex last) {
    return std::count_if(kept.begin(), kept.end(),
                         [&](PointIndex p) { return p >= first && p < last; });
  }

  Scene scene_;
  std::mt19937 random_{test_seed()};
};

TEST_F(Crowns, WhatRisesAboveTheTreesAroundStays) {
  for (const bool tall_trees : {false, true}) {
    SCOPED_TRACE(::testing::Message() << tall_trees << " " << test_seed());
    scene_ = {};
    scan_roof([](double, double) { return 2.8; }, 500);
    scan_tree(300);  // up to 12 m
    const auto first = static_cast<PointIndex>(scene_.cloud.size());
    for (int k = 0; k < 60; ++k)
      scene_.add(scene_.roof, 6 * share(), 8 * share(), 16 + 6 * share());
    const auto last = static_cast<PointIndex>(scene_.cloud.size());
    if (tall_trees) scene_.add(scene_.around, -1, 4, 22);
    const auto kept_above = among(kept(), first, last);
    if (tall_trees)
      EXPECT_LT(kept_above, 12);
    else
      EXPECT_EQ(kept_above, 60);
  }
}

TEST_F(Crowns, ATreeOverAShedGoesAndTheShedStays) {
  SCOPED_TRACE(test_seed());
  scan_roof([](double, double) { return 2.8; }, 500);
  scan_tree(300);
  const auto points = kept();
  EXPECT_EQ(among(points, 0, 500), 500);
  EXPECT_LT(among(points, 500, 800), 60);
}

TEST_F(Crowns, WhatIsLittleHigherThanTheRoofGoesNextToACrownOnly) {
  SCOPED_TRACE(test_seed());
  constexpr int kScans = 10, kLow = 12;
  for (const bool crown : {true, false}) {
    SCOPED_TRACE(crown);
    std::ptrdiff_t kept_low = 0;  // of all scans: of one, chance may keep half
    for (int scan = 0; scan < kScans; ++scan) {
      scene_ = {};
      scan_roof([](double, double) { return 2.8; }, 500);
      scan_trees_around(12);
      const auto first = static_cast<PointIndex>(scene_.cloud.size());
      for (int k = 0; k < kLow; ++k)
        scene_.add(scene_.roof, 6 * share(), 8 * share(), 3.9 + 0.3 * share());
      const auto last = static_cast<PointIndex>(scene_.cloud.size());
      if (crown)
        for (int k = 0; k < 200; ++k)
          scene_.add(scene_.roof, 6 * share(), 8 * share(), 4.4 + 4 * share());
      kept_low += among(kept(), first, last);
    }
    if (crown)
      EXPECT_LT(kept_low, kScans * kLow / 2);
    else
      EXPECT_EQ(kept_low, kScans * kLow);
  }
}

/// More points of the neighbour's wall than of its roof are near: the level says nothing, but what
/// is as high there is a surface.
TEST_F(Crowns, OnTheWallOfAHigherRoofIsNoCrown) {
  SCOPED_TRACE(test_seed());
  scan_roof([](double, double) { return 6.0; }, 500);
  scan_trees_around(20);
  for (int k = 0; k < 40; ++k) scene_.add(scene_.beside, 10.1, 3.5 + share(), 7 + 8 * share());
  for (int k = 0; k < 16; ++k)
    scene_.add(scene_.beside, 10.3 + 0.15 * (k % 4), 3.7 + 0.15 * (k / 4), 20);
  const auto wall = static_cast<PointIndex>(scene_.cloud.size());
  scene_.add(scene_.roof, 9.95, 4, 18.6);
  EXPECT_EQ(among(kept(), wall, wall + 1), 1);
}

TEST_F(Crowns, TreesOverOpenGroundLeaveNoRoof) {
  for (int k = 0; k < 300; ++k) scene_.add(scene_.below, 10 * share(), 8 * share(), noise());
  scan_tree(300);
  EXPECT_TRUE(kept().empty());
}

TEST_F(Crowns, TreesInAnOutlineThatIsMostlyGroundAreNoRoof) {
  // No tree stands around: a park over a garage.
  for (int k = 0; k < 400; ++k) scene_.add(scene_.below, 10 * share(), 8 * share(), noise());
  for (int k = 0; k < 150; ++k)
    scene_.add(scene_.roof, 2 + 4 * share(), 2 + 4 * share(), 4 + 6 * share());
  EXPECT_TRUE(kept().empty());
  // But a pavilion is one.
  scene_ = {};
  for (int k = 0; k < 400; ++k) scene_.add(scene_.below, 10 * share(), 8 * share(), noise());
  for (int k = 0; k < 200; ++k)
    scene_.add(scene_.roof, 2 + 4 * share(), 2 + 4 * share(), 4 + noise());
  EXPECT_GT(kept().size(), 190U);
}

TEST_F(Crowns, RoofsBesideTreesStay) {
  SCOPED_TRACE(test_seed());
  const std::vector<std::function<double(double, double)>> roofs = {
      [](double, double y) { return 9 + 1.2 * (4 - std::abs(y - 4)); },         // gable, 50 degrees
      [](double x, double) { return x < 5 ? 4.0 : 12.0; },                      // a step
      [](double x, double y) { return x > 3 && x < 6 && y < 3 ? 20.0 : 7.0; },  // a tower
  };
  for (const auto& roof : roofs) {
    scene_ = {};
    scan_roof(roof, 600);
    for (int k = 0; k < 300; ++k)
      scene_.add(scene_.around, -3 + 2 * share(), 8 * share(), 5 + 15 * share());
    EXPECT_GT(kept().size(), 590U);
  }
}

TEST_F(Crowns, WithoutTreesAroundNothingIsTouched) {
  scan_roof([&](double, double) { return 3 + 10 * share(); }, 400);  // as ragged as a tree
  EXPECT_EQ(kept().size(), 400U);
}

TEST_F(Crowns, TheSameForAnyNumberOfThreads) {
  SCOPED_TRACE(test_seed());
  // Buildings with trees over them and without, more than one thread takes at a time.
  constexpr int kBuildings = 23;
  Scene all;
  for (PointLists* list : {&all.roof, &all.below, &all.around, &all.beside}) list->offsets = {0};
  for (int b = 0; b < kBuildings; ++b) {
    scene_ = {};
    scan_roof([&](double, double) { return 3 + b % 5; }, 200 + 20 * b);
    if (b % 3 != 0) scan_tree(150);
    const auto first = static_cast<PointIndex>(all.cloud.size());
    all.cloud.x.insert(all.cloud.x.end(), scene_.cloud.x.begin(), scene_.cloud.x.end());
    all.cloud.y.insert(all.cloud.y.end(), scene_.cloud.y.begin(), scene_.cloud.y.end());
    all.cloud.z.insert(all.cloud.z.end(), scene_.cloud.z.begin(), scene_.cloud.z.end());
    all.cloud.classification.resize(all.cloud.x.size(), kUnclassified);
    for (const auto& [from, to] : {std::pair{&scene_.roof, &all.roof},
                                   {&scene_.below, &all.below},
                                   {&scene_.around, &all.around},
                                   {&scene_.beside, &all.beside}}) {
      for (const PointIndex p : from->values) to->values.push_back(first + p);
      to->offsets.push_back(static_cast<std::int64_t>(to->values.size()));
    }
  }
  const auto kept_by = [&](int threads) {
    const ThreadLimit limit(threads);
    PointLists roof = all.roof;
    drop_tree_crowns(roof, {all.below, all.around, all.beside}, all.cloud);
    return roof;
  };
  const PointLists one = kept_by(1), four = kept_by(4);
  EXPECT_EQ(one.offsets, four.offsets);
  EXPECT_EQ(one.values, four.values);
  EXPECT_LT(one.values.size(), all.roof.values.size() - 500);
  EXPECT_EQ(one.offsets.size(), kBuildings + 1U);
}

TEST_F(Crowns, EmptyListsAndPointsAtOnePlace) {
  EXPECT_TRUE(kept().empty());
  for (int k = 0; k < 30; ++k) {
    scene_.add(scene_.roof, 1, 1, 5);
    scene_.add(scene_.around, -2, 1, 15);
  }
  EXPECT_EQ(kept().size(), 30U);
}

}  // namespace
}  // namespace tetropolis
