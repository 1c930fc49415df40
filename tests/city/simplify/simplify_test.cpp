#include "tetropolis/city/simplify/simplify.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/io/vector/vector.h"

#include "city/footprint_checks.h"
#include "support/indices.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::circle;
using testing::cleaned;
using testing::clockwise_box;
using testing::domain_around;
using testing::expect_sound;
using testing::indices_of;
using testing::random_star;
using testing::simplified;
using testing::turned;

double kept_change(const Simplification& s) {
  return s.stats.symmetric_difference - s.stats.area_dropped;
}

// --- pairs -----------------------------------------------------------------------------------

TEST(Simplify, LeavesFootprintsThatAreFine) {
  const std::vector<Polygon> input = cleaned({box(0, 0, 10, 10), box(11.001, 0, 10, 10)});
  const Simplification result = simplified(input);
  EXPECT_EQ(result.footprints, input);
  EXPECT_EQ(result.flags, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_EQ(result.stats.symmetric_difference, 0);
}

TEST(Simplify, FillsTheGapBetweenTwoWalls) {
  for (const double angle : {0.0, 0.3, 1.0}) {
    const Simplification result =
        simplified({turned(box(0, 0, 10, 10), angle), turned(box(10.5, 0, 10, 10), angle)});
    ASSERT_EQ(result.footprints.size(), 1U);
    EXPECT_EQ(result.flags[0], kMerged | kRepaired);
    EXPECT_NEAR(area(result.footprints[0]), 205, 0.05);
    EXPECT_EQ(result.footprints[0].outer.size(), 4U);
  }
}

TEST(Simplify, FillsOnlyTheFacingPartOfTheGap) {
  // The second is shifted by half: 5 m face each other.
  const Simplification result = simplified({box(0, 0, 10, 10), box(10.5, 5, 10, 10)});
  ASSERT_EQ(result.footprints.size(), 1U);
  // 5 m by 0.5 m, and two slanted ends that are 1 m long.
  EXPECT_NEAR(area(result.footprints[0]), 200 + 2.5 + 0.5 * std::sqrt(0.75), 0.01);
}

TEST(Simplify, BridgesCorners) {
  for (const double gap : {0.0, 0.3, -0.2}) {
    const Simplification result = simplified({box(0, 0, 10, 10), box(10 + gap, 10 + gap, 10, 10)});
    ASSERT_EQ(result.footprints.size(), 1U) << gap;
    EXPECT_NEAR(area(result.footprints[0]), 200, 2.5) << gap;
    EXPECT_EQ(result.flags[0] & kConvexHull, 0U);
  }
}

TEST(Simplify, UnitesOverlappingContainedAndIdenticalOnes) {
  const Simplification overlapping = simplified({box(0, 0, 10, 10), box(5, 5, 10, 10)});
  ASSERT_EQ(overlapping.footprints.size(), 1U);
  EXPECT_NEAR(area(overlapping.footprints[0]), 175, 1e-9);
  EXPECT_EQ(overlapping.flags[0], kMerged);  // nothing is off what came in
  const Simplification contained = simplified({box(0, 0, 20, 20), box(5, 5, 5, 5)});
  ASSERT_EQ(contained.footprints.size(), 1U);
  EXPECT_NEAR(area(contained.footprints[0]), 400, 1e-9);
  const Simplification twice = simplified({box(0, 0, 20, 20), box(0, 0, 20, 20)});
  ASSERT_EQ(twice.footprints.size(), 1U);
  EXPECT_NEAR(area(twice.footprints[0]), 400, 1e-9);
  EXPECT_EQ(twice.members[0], (indices_of<BuildingIndex>({0, 1})));
}

TEST(Simplify, JoinsLShapes) {
  const Polygon l{{{0, 0}, {20, 0}, {20, 5}, {5, 5}, {5, 20}, {0, 20}}, {}};
  // A box nested in the L, 0.4 m from both of its arms: both gaps are filled.
  const Simplification result = simplified({l, box(5.4, 5.4, 10, 10)});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_NEAR(area(result.footprints[0]), 175 + 100 + 10.4 * 10.4 - 100, 1.0);
}

TEST(Simplify, ClosesCracksAndJunctionsOffByAMicrometre) {
  const double tiny = 1e-6;
  const Simplification junction =
      simplified({box(0, 0, 10, 10), box(10 + tiny, 0, 10, 5), box(10 - tiny, 5 + tiny, 10, 5)});
  ASSERT_EQ(junction.footprints.size(), 1U);
  EXPECT_NEAR(area(junction.footprints[0]), 200, 1e-3);
  EXPECT_EQ(junction.footprints[0].outer.size(), 4U);
  const Simplification crack =
      simplified({turned(box(0, 0, 10, 10), 0.7), turned(box(10.01, 0, 10, 10), 0.7)});
  ASSERT_EQ(crack.footprints.size(), 1U);
  EXPECT_NEAR(area(crack.footprints[0]), 200.1, 0.01);
  // Walls that touch at one end and are 2 cm apart at the other.
  const Simplification wedge =
      simplified({box(0, 0, 10, 10), turned(box(10, 0, 10, 10), -0.002, {10, 0})});
  ASSERT_EQ(wedge.footprints.size(), 1U);
  EXPECT_NEAR(area(wedge.footprints[0]), 200.1, 0.1);
}

TEST(Simplify, CheckerboardsHoldTogether) {
  std::vector<Polygon> input;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y)
      if ((x + y) % 2 == 0) input.push_back(box(8.0 * x, 8.0 * y, 8, 8));
  const Simplification result = simplified(input);
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_EQ(result.flags[0] & kConvexHull, 0U);
  EXPECT_LT(kept_change(result), 0.05 * result.stats.area_before);
}

// --- features of one footprint ------------------------------------------------------------------

TEST(Simplify, RepairsStepsGently) {
  // A facade of 60 m with a step of 0.3 m: slanting the step changes 0.07 m2, moving a wall 9 m2.
  const Simplification result =
      simplified({{{{0, 0}, {60, 0}, {60, 10}, {30, 10}, {30, 10.3}, {0, 10.3}}, {}}});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_LT(kept_change(result), 0.1);
  EXPECT_NEAR(area(result.footprints[0]), 609, 0.01);
  EXPECT_EQ(result.stats.edges_slid, 1);
}

TEST(Simplify, FillsNotchesAndCutsThinArms) {
  const Polygon notch{
      {{0, 0}, {20, 0}, {20, 20}, {10.5, 20}, {10.5, 12}, {10, 12}, {10, 20}, {0, 20}}, {}};
  const Simplification filled = simplified({notch});
  ASSERT_EQ(filled.footprints.size(), 1U);
  EXPECT_NEAR(area(filled.footprints[0]), 400, 1e-6);
  // A garden wall of 5 cm and 15 m.
  const Polygon wall{{{0, 0}, {10, 0}, {10, 9.95}, {25, 9.95}, {25, 10}, {0, 10}}, {}};
  const Simplification cut = simplified({wall});
  ASSERT_EQ(cut.footprints.size(), 1U);
  EXPECT_NEAR(area(cut.footprints[0]), 100, 0.2);
}

TEST(Simplify, FillsCombsInsteadOfTradingTeethForGaps) {
  Polygon comb{{{0, 0}, {40, 0}}, {}};
  for (int i = 40; i-- > 0;)
    for (const Point2 p : {Point2{i + 0.5, 30}, {i + 0.5, 20}, {i + 0.0, 20}, {i + 0.0, 30}})
      comb.outer.push_back(p);
  comb.outer.insert(comb.outer.begin() + 2, {40, 30});
  const Simplification result = simplified({comb});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_NEAR(area(result.footprints[0]), 40 * 30, 10);
  EXPECT_LE(result.stats.rounds, 3);
}

TEST(Simplify, JoinsBlocksMillimetresApartWithoutHulls) {
  // From Amsterdam: two blocks along a line, a few millimetres apart at one end, at 0.5 m.
  SimplifyOptions options;
  options.min_distance = 0.5;
  const Simplification result =
      simplified({{{{52.714, 175.585}, {47.694, 173.414}, {52.46, 162.876}, {57.482, 165.025}}, {}},
                  {{{55.301, 184.558}, {50.053, 182.26}, {52.934, 175.68}, {58.201, 177.934}}, {}},
                  {{{58.201, 177.934},
                    {52.714, 175.585},
                    {57.54, 164.897},
                    {58.059, 165.112},
                    {58.005, 165.241},
                    {61.388, 166.647},
                    {61.442, 166.518},
                    {62.948, 167.143}},
                   {}}},
                 options);
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_EQ(result.stats.hulls, 0);
  EXPECT_LT(result.changes[0].hausdorff_distance, 0.5);
}

TEST(Simplify, WidensCorridorsAlongTheirWalls) {
  // Two halls and a slanted corridor of 0.6 m between them.
  for (const double slope : {0.0, 0.3, 0.8}) {
    const Simplification result = simplified({{{{0, 0},
                                                {20, 0},
                                                {20, 8},
                                                {30, 8 + 10 * slope},
                                                {30, 0},
                                                {50, 0},
                                                {50, 30},
                                                {30, 30},
                                                {30, 8.6 + 10 * slope + 0.2 * slope},
                                                {20, 8.6 + 0.2 * slope},
                                                {20, 30},
                                                {0, 30}},
                                               {}}});
    ASSERT_EQ(result.footprints.size(), 1U) << slope;
    EXPECT_GT(area(result.footprints[0]), 1200) << slope;
    EXPECT_LT(result.stats.max_hausdorff_distance, 1.0) << slope;
    EXPECT_LT(kept_change(result), 12) << slope;
  }
}

TEST(Simplify, KeepsBothHallsOfADumbbell) {
  // Two halls joined by a corridor of 0.6 m: cutting it would lose a hall.
  const Polygon dumbbell{{{0, 0},
                          {20, 0},
                          {20, 9.7},
                          {30, 9.7},
                          {30, 0},
                          {50, 0},
                          {50, 20},
                          {30, 20},
                          {30, 10.3},
                          {20, 10.3},
                          {20, 20},
                          {0, 20}},
                         {}};
  const Simplification result = simplified({dumbbell});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_EQ(result.flags[0] & kConvexHull, 0U);
  EXPECT_NEAR(area(result.footprints[0]), 810, 12);
}

TEST(Simplify, NeedlesLoseTheirTip) {
  // An angle of 0.5 degrees, 100 m long.
  const double w = 100 * std::tan(0.5 / 180 * std::numbers::pi);
  const Polygon needle{{{0, 0}, {100, 10 - w}, {0, 10}}, {}};
  const Simplification house = simplified({needle});
  ASSERT_EQ(house.footprints.size(), 1U);
  const Polygon slot{{{0, 0}, {110, 0}, {110, 10}, {105, 10}, {5, 10 - w}, {0, 10}}, {}};
  simplified({slot});
  const Polygon spike{{{0, 0}, {20, 0}, {20, 10}, {120, 10 + w / 2}, {20, 10 + w}, {0, 20}}, {}};
  const Simplification result = simplified({spike});
  ASSERT_EQ(result.footprints.size(), 1U);
  // It is a metre wide 43 m from its foot.
  EXPECT_GE(area(result.footprints[0]), 299);
  EXPECT_LE(area(result.footprints[0]), 300 + 60);
}

/// What is as far apart as asked is not too close.
TEST(Simplify, AlleysAsWideAsTheThresholdStay) {
  for (const double step : {0.0, 0.0001, 0.03, 0.1234}) {
    std::vector<Polygon> houses;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        // On the grid as far as binary numbers are.
        const double x = std::round((20 + step + 6 * i) * 1e4) / 1e4;
        const double y = std::round((30 + 7 * step + 6 * j) * 1e4) / 1e4;
        houses.push_back({{{x, y}, {x + 5, y}, {x + 5, y + 5}, {x, y + 5}}, {}});
      }
    const Simplification result = simplified(houses);
    EXPECT_EQ(result.footprints.size(), 36U) << step;
    EXPECT_EQ(kept_change(result), 0) << step;
  }
}

/// Degrees, of the sharpest corner on either side of the outline.
double sharpest_corner(const Simplification& result) {
  double least = 180;
  const auto look = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 a = ring[(i + ring.size() - 1) % ring.size()], b = ring[i],
                   c = ring[(i + 1) % ring.size()];
      const double ux = a.x - b.x, uy = a.y - b.y, vx = c.x - b.x, vy = c.y - b.y;
      const double angle = std::abs(std::atan2(ux * vy - uy * vx, ux * vx + uy * vy));
      least = std::min(least, angle * 180 / std::numbers::pi);
    }
  };
  for (const Polygon& polygon : result.footprints) for_each_ring(polygon, look);
  return least;
}

TEST(Simplify, WedgesBetweenWallsAreFilledWhereTheyAreNarrow) {
  for (const double degrees : {1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.5}) {
    SCOPED_TRACE(degrees);
    const double turn = degrees * std::numbers::pi / 180;
    // Two slabs that cross: four wedges of air, two of them long.
    const Simplification result = simplified({box(0, 0, 60, 10), turned(box(0, 2, 60, 10), turn)});
    ASSERT_EQ(result.footprints.size(), 1U);
    EXPECT_GE(sharpest_corner(result), 13);
    // A wedge is filled over 1 m / (2 sin(angle / 2)), up to 1 m wide.
    EXPECT_LE(kept_change(result), 4 * 0.5 / (2 * std::sin(turn / 2)) + 2);
    EXPECT_EQ(result.stats.hulls, 0);
  }
}

/// A corner of 8.6 degrees that cannot be cut, because that is most of the yard, nor widened,
/// because the walls around are a metre thick.
TEST(Simplify, SmallYardsWithSharpCornersAreFilled) {
  const Polygon block{{{73.18, 60.72},
                       {76.15, 67.49},
                       {78.08, 66.75},
                       {75.62, 57.61},
                       {73.65, 57.77},
                       {73.12, 60.12}},
                      {{{74.135, 60.299}, {77.075, 67.001}, {74.651, 57.995}}}};
  const Simplification result = simplified({block});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_TRUE(result.footprints[0].holes.empty());
  EXPECT_GE(sharpest_corner(result), 13);
  EXPECT_NE(result.flags[0] & kRepaired, 0U);
}

/// Arms that are most of the area, and feet between which there is no room for what is cut. For one
/// star in thousands no way may be found.
TEST(Simplify, StarsHaveHardlyAnySharpCornersLeft) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int sharp = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int arms = std::uniform_int_distribution<int>(5, 24)(random);
    const double outer = uniform(8, 40), inner = outer * uniform(0.03, 0.5), turn = uniform(0, 1);
    Ring ring;
    for (int i = 0; i < 2 * arms; ++i) {
      const double a = turn + std::numbers::pi * i / arms, r = i % 2 == 0 ? outer : inner;
      ring.push_back({100 + r * std::cos(a), 100 + r * std::sin(a)});
    }
    const Simplification result = simplified({{ring, {}}});
    if (result.footprints.empty()) continue;
    sharp += sharpest_corner(result) < 13 ? 1 : 0;
  }
  EXPECT_LE(sharp, 1);
}

/// What the boundary of the domain leaves of a slab at a small angle to it, and wedges along it.
TEST(Simplify, SliversAlongTheBoundaryHaveNoSharpCorners) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int sharp = 0, left = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SimplifyOptions options;
    options.min_distance = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 1.5 : 2;
    const double turn = uniform(0.5, 13) * std::numbers::pi / 180 * (trial % 2 == 0 ? 1 : -1);
    Polygon slab = turned(box(0, 0, 24, 10), turn);
    double low = 1e9;
    for (const Point2 p : slab.outer) low = std::min(low, p.y);
    const double depth = uniform(0, 10);  // of the slab beyond what the boundary leaves
    for (Point2& p : slab.outer) p = {p.x + 30, p.y - low - depth + options.min_distance};
    if (trial % 5 == 0) {
      const double length = uniform(15, 40), y = options.min_distance;
      slab = {{{20, y}, {20 + length, y}, {20 + length, y + length * std::abs(std::tan(turn))}},
              {}};
    }
    const Simplification result =
        simplify_footprints(cleaned({slab}), Bounds2{0, 0, 80, 80}, options);
    left += static_cast<int>(result.footprints.size());
    sharp += sharpest_corner(result) < 13 ? 1 : 0;
  }
  EXPECT_EQ(sharp, 0);
  EXPECT_GT(left, 150);
}

/// A needle of 5 degrees beside another wall: what is left where it is a metre wide is in the way
/// of that wall, and a tip of that width has no room either.
TEST(Simplify, SharpEndsAreCutFurtherWhereTheirFootHasNoRoom) {
  const Simplification result = simplified({{{{56.812, 76.527},
                                              {60.244, 75.821},
                                              {63.179, 64.864},
                                              {60.787, 78.089},
                                              {62.15, 75.77},
                                              {64.574, 85.072}},
                                             {}}});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_GE(sharpest_corner(result), 13);
  EXPECT_LE(kept_change(result), 9);
}

TEST(Simplify, SharpEndsAreCutWhereTheyAreNarrow) {
  for (const double degrees : {2.0, 4.0, 8.0, 12.5}) {
    SCOPED_TRACE(degrees);
    const double base = 60 * std::tan(degrees * std::numbers::pi / 180);
    const double length = 0.5 / std::sin(degrees * std::numbers::pi / 360);
    const Polygon sharp{{{0, 0}, {60, 0}, {60, base}}, {}};
    const Simplification result = simplified({sharp});
    ASSERT_EQ(result.footprints.size(), 1U);
    EXPECT_EQ(result.stats.corners_chamfered, 1);
    EXPECT_GE(sharpest_corner(result), 13);
    EXPECT_NEAR(kept_change(result), 0.5 * length, 0.1);
    EXPECT_NEAR(result.stats.max_hausdorff_distance, length, 0.1);
    // As the yard of a block, turned round.
    Polygon block{box(-20, -20, 100, 60).outer, {}};
    block.holes.push_back({sharp.outer.rbegin(), sharp.outer.rend()});
    const Simplification yard = simplified({block});
    EXPECT_EQ(yard.stats.corners_chamfered, 1);
    EXPECT_GE(sharpest_corner(yard), 13);
  }
  // 14 degrees stay.
  const Polygon fine{{{0, 0}, {60, 0}, {60, 15}}, {}};
  EXPECT_EQ(simplified({fine}).footprints, cleaned({fine}));
}

TEST(Simplify, OutlinesOfThousandsOfTeeth) {
  Polygon star;
  for (int i = 0; i < 1500; ++i) {
    const double angle = 2 * std::numbers::pi * i / 1500, r = i % 2 == 0 ? 60 : 55;
    star.outer.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  const Simplification result = simplified({star});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_LT(kept_change(result), 0.1 * std::numbers::pi * 60 * 60);
}

TEST(Simplify, CourtyardsSurviveWhereTheyMay) {
  Polygon large = box(0, 0, 40, 40);
  large.holes.push_back(clockwise_box(10, 10, 20, 20));
  const Simplification kept = simplified({large, box(15, 15, 10, 10)});
  ASSERT_EQ(kept.footprints.size(), 2U);
  EXPECT_EQ(kept.footprints[0], large);
  Polygon narrow = box(0, 0, 40, 40);
  narrow.holes.push_back(clockwise_box(10, 10, 0.5, 20));
  const Simplification closed = simplified({narrow});
  ASSERT_EQ(closed.footprints.size(), 1U);
  EXPECT_TRUE(closed.footprints[0].holes.empty());
  EXPECT_NEAR(area(closed.footprints[0]), 1600, 1e-6);
  // A house 0.4 m from all walls of its courtyard fills it.
  Polygon tight = box(0, 0, 40, 40);
  tight.holes.push_back(clockwise_box(10, 10, 20, 20));
  const Simplification one = simplified({tight, box(10.4, 10.4, 19.2, 19.2)});
  ASSERT_EQ(one.footprints.size(), 1U);
  EXPECT_NEAR(area(one.footprints[0]), 1600, 1.0);
  // A courtyard 0.3 m from the street.
  Polygon thin = box(0, 0, 40, 40);
  thin.holes.push_back(clockwise_box(0.3, 10, 20, 20));
  simplified({thin});
}

// Neither wings nor courtyards are as wide as the distance.
TEST(Simplify, HousesAroundSmallCourtyardsAreNotLost) {
  const auto house = [](double width, double depth, double wing) {
    Polygon outline = box(20, 20, width, depth);
    outline.holes.push_back(
        clockwise_box(20 + wing, 20 + wing, width - 2 * wing, depth - 2 * wing));
    return outline;
  };
  struct Case {
    Polygon house;
    double distance;
  };
  for (const auto& [outline, distance] :
       {Case{house(40, 35, 10), 15}, Case{house(12.6, 12, 3), 5}, Case{house(8, 7.5, 2), 3},
        Case{house(20, 18, 4.5), 7.5}, Case{house(14, 13, 3.3), 5.2}}) {
    SCOPED_TRACE(distance);
    SimplifyOptions options;
    options.min_distance = distance;
    const Simplification result = simplified({outline}, options);
    ASSERT_EQ(result.footprints.size(), 1U);
    EXPECT_GT(area(result.footprints[0]), 0.8 * area(outline));
  }
  // But a wall around a garden is no block.
  SimplifyOptions options;
  options.min_distance = 2;
  const Simplification wall = simplified({house(60, 60, 0.9)}, options);
  EXPECT_TRUE(wall.footprints.empty() || area(wall.footprints[0]) < 600);
}

TEST(Simplify, CirclesBecomePolygonsOfMetreEdges) {
  const Simplification result =
      simplified({circle({0, 0}, 50, 4000), circle({101, 0}, 50.2, 4000)});
  ASSERT_EQ(result.footprints.size(), 1U);
  EXPECT_LT(kept_change(result) / result.stats.area_before, 2e-3);
}

TEST(Simplify, DropsSmallAndNarrowOnesWithTheReason) {
  const Simplification small = simplified({box(0, 0, 3, 3), box(50, 0, 0.02, 0.02)});
  EXPECT_TRUE(small.footprints.empty());
  ASSERT_EQ(small.dropped.size(), 2U);
  EXPECT_EQ(small.dropped[0].reason, "area 9.0 m2 below the minimum of 15 m2");
  // Small ones that touch a larger one count with it.
  EXPECT_EQ(simplified({box(0, 0, 3, 3), box(3, 0, 10, 10)}).dropped.size(), 0U);
  // A wall of 40 m and 0.1 m.
  SimplifyOptions options;
  options.min_area = 1;
  const Simplification wall = simplified({box(0, 0, 40, 0.1)}, options);
  ASSERT_EQ(wall.dropped.size(), 1U);
  EXPECT_EQ(wall.dropped[0].reason, "too small or narrow for the merge distance");
}

// --- the domain -------------------------------------------------------------------------------

TEST(Simplify, KeepsAwayFromTheDomainBoundary) {
  const Bounds2 domain{0, 0, 100, 100};
  const std::vector<Polygon> input = cleaned(
      {box(0.2, 50, 10, 10), box(95, 95, 5.3, 5.3), box(99.5, 10, 10, 10), box(-40, 0, 10, 10)});
  const Simplification result = simplify_footprints(input, domain, {});
  expect_sound(result, input.size(), domain, {});
  ASSERT_EQ(result.footprints.size(), 2U);
  EXPECT_NE(result.flags[0] & kClipped, 0U);
  EXPECT_NEAR(area(result.footprints[0]), 92, 0.01);
  EXPECT_NEAR(area(result.footprints[1]), 16, 0.01);
  ASSERT_EQ(result.dropped.size(), 2U);
  EXPECT_EQ(result.dropped[0].index, 2);
  EXPECT_EQ(result.dropped[0].reason, "closer than the merge distance to the domain boundary");
  EXPECT_EQ(result.stats.clipped, 2);
  // A domain without any room.
  EXPECT_EQ(simplify_footprints(input, {0, 0, 1, 1}, {}).dropped.size(), input.size());
}

TEST(Simplify, RejectsOptionsOutOfRange) {
  for (const double bad : {0.0, -1.0, 1e4, std::nan("")}) {
    SimplifyOptions options;
    options.min_distance = bad;
    EXPECT_THROW(simplify_footprints({}, {0, 0, 1, 1}, options), Error);
  }
  SimplifyOptions options;
  options.growths = 0;
  EXPECT_THROW(simplify_footprints({}, {0, 0, 1, 1}, options), Error);
}

TEST(Simplify, StopsWhenAsked) {
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(simplify_footprints({}, {0, 0, 1, 1}, {}, progress), Cancelled);
  double last = 0;
  Progress watch;
  watch.report = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  // A field of boxes closer than the distance in pairs, so that every step has something to do.
  std::vector<Polygon> input;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 20; ++j) {
      const double x = 20.0 * i + 10, y = 20.0 * j + 10;
      input.push_back(box(x, y, 5, 8));
      input.push_back(box(x + 5.3, y + 1, 5, 8));
    }
  const Bounds2 domain{0, 0, 820, 420};
  int polls = 0;
  watch.cancelled = [&] {
    ++polls;
    return false;
  };
  simplify_footprints(input, domain, {}, watch);
  EXPECT_EQ(last, 1);
  // Clusters are polled one by one, changes by sixteens; whichever poll says stop, it stops.
  EXPECT_GT(polls, 800 + 800 / 16);
  for (const int at : {1, 2, 5, 100, 500, 803, polls - 20, polls - 1}) {
    int count = 0;
    Progress stop;
    stop.cancelled = [&] { return ++count >= at; };
    EXPECT_THROW(simplify_footprints(input, domain, {}, stop), Cancelled) << at;
    EXPECT_LE(count, at + 64);  // threads that were at work
  }
}

/// A corner of a yard that cannot be chamfered: it is tried before small ones are dropped, and
/// after.
TEST(Simplify, ProgressNeverGoesBack) {
  const Polygon block{{{0, 0}, {73, 0.6009}, {73, 2.6217}, {0, 3.2227}},
                      {{{1.0004, 1.0804}, {1.0004, 2.1423}, {69, 1.6113}}}};
  double last = 0;
  Progress watch;
  watch.report = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  const std::vector<Polygon> input = cleaned({block, box(100, 0, 2, 2)});
  const Simplification result = simplify_footprints(input, domain_around(input), {}, watch);
  EXPECT_EQ(last, 1);
  EXPECT_EQ(result.dropped.size(), 1U);
  EXPECT_LT(sharpest_corner(result), 13);
}

TEST(Simplify, StopsWithinTheUnionOfOneLargeCluster) {
  // A woven mat: every box overlaps its neighbours.
  std::vector<Polygon> input;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) input.push_back(box(10.0 * i + 10 + j % 2, 10.0 * j + 10, 12, 12));
  const Bounds2 domain{0, 0, 640, 640};
  int polls = 0;
  Progress watch;
  watch.cancelled = [&] {
    ++polls;
    return false;
  };
  EXPECT_EQ(simplify_footprints(input, domain, {}, watch).footprints.size(), 1U);
  // Quarters of quarters of it are united apart, and the whole has hardly any other polls.
  EXPECT_GT(polls, 3600 / 128);
  for (const int at : {5, 10, 20}) {
    int count = 0;
    Progress stop;
    stop.cancelled = [&] { return ++count >= at; };
    EXPECT_THROW(simplify_footprints(input, domain, {}, stop), Cancelled) << at;
  }
}

// --- how far the result is from the input ------------------------------------------------------

TEST(Simplify, StatesHowFarItWent) {
  // A slot of 0.8 m: its middle line is 0.4 m from the walls.
  const Simplification slot =
      simplified({{box(0, 0, 20, 20).outer, {clockwise_box(5, 5, 10, 0.8)}}});
  ASSERT_EQ(slot.changes.size(), 1U);
  EXPECT_NEAR(slot.changes[0].hausdorff_distance, 0.4, 0.011);
  EXPECT_NEAR(slot.changes[0].at.y, 5.4, 0.02);
  EXPECT_NEAR(slot.changes[0].symmetric_difference, 8, 1e-9);
  // A garden wall of 5 cm and 15 m is cut off.
  const Simplification cut =
      simplified({{{{0, 0}, {10, 0}, {10, 9.95}, {25, 9.95}, {25, 10}, {0, 10}}, {}}});
  ASSERT_EQ(cut.changes.size(), 1U);
  EXPECT_NEAR(cut.stats.max_hausdorff_distance, 15, 0.02);
  EXPECT_NEAR(cut.changes[0].at.x, 25, 0.02);
  const Simplification nothing = simplified({box(0, 0, 20, 20)});
  ASSERT_EQ(nothing.changes.size(), 1U);
  EXPECT_EQ(nothing.stats.max_hausdorff_distance, 0);
}

/// The largest distance between points of one list of polygons and the other list, over samples.
double sampled_distance(const std::vector<Polygon>& before, const std::vector<Polygon>& after,
                        double step) {
  const auto inside = [](const std::vector<Polygon>& polygons, Point2 p) {
    return std::any_of(polygons.begin(), polygons.end(),
                       [&](const Polygon& polygon) { return contains(polygon, p); });
  };
  const auto distance = [](const std::vector<Polygon>& polygons, Point2 p) {
    double least = 1e9;
    for (const Polygon& polygon : polygons)
      for_each_edge(polygon, [&](Point2 a, Point2 b) {
        least = std::min(least, distance_to_segment(p, a, b));
      });
    return least;
  };
  const Bounds2 box = domain_around(before);
  double largest = 0;
  for (double y = box.ymin; y < box.ymax; y += step)
    for (double x = box.xmin; x < box.xmax; x += step) {
      const bool in_before = inside(before, {x, y}), in_after = inside(after, {x, y});
      if (in_before != in_after)
        largest = std::max(largest, distance(in_before ? after : before, {x, y}));
    }
  // Tips are narrower than the step.
  const auto corners = [&](const std::vector<Polygon>& of, const std::vector<Polygon>& others) {
    for (const Polygon& polygon : of)
      for_each_edge(polygon, [&](Point2 a, Point2) {
        if (!inside(others, a)) largest = std::max(largest, distance(others, a));
      });
  };
  corners(before, after);
  corners(after, before);
  return largest;
}

TEST(Simplify, WhatTheDomainCutsOffIsNoChange) {
  const Bounds2 domain{0, 0, 100, 100};
  const SimplifyOptions options;
  // Half a metre from the boundary on all four sides, alone or with another inside.
  const Polygon wide = box(0.5, 0.5, 99, 99);
  for (const std::vector<Polygon>& raw : {std::vector{wide}, std::vector{wide, box(5, 5, 9, 9)}}) {
    const Simplification result = simplify_footprints(cleaned(raw), domain, options);
    expect_sound(result, raw.size(), domain, options);
    ASSERT_EQ(result.footprints.size(), 1U);
    EXPECT_NE(result.flags[0] & kClipped, 0U);
    EXPECT_NEAR(area(result.footprints[0]), 98 * 98, 0.2);
    EXPECT_NEAR(result.stats.area_before, area(result.footprints[0]), 1e-6);
    EXPECT_EQ(result.changes[0].hausdorff_distance, 0);
    EXPECT_NEAR(result.stats.symmetric_difference, 0, 1e-6);
  }
}

// --- members that a cut parts -----------------------------------------------------------------

/// Houses of 10 m by 10 m or more from x to x0 and from x1 on, and a wall of 20 cm between them. It
/// is too long to be widened.
Polygon walled_houses(double x, double x0, double x1, double end) {
  return {{{x, 0},
           {x0, 0},
           {x0, 5},
           {x1, 5},
           {x1, 0},
           {end, 0},
           {end, 10},
           {x1, 10},
           {x1, 5.2},
           {x0, 5.2},
           {x0, 10},
           {x, 10}},
          {}};
}

TEST(Simplify, AMemberInsideAnotherMayGetAllOfAHouse) {
  // The right house is the larger one when its slot is filled; before, it is the smaller one, so
  // all of the first belongs to the left house, and the second is left with nothing of its own.
  Polygon first = walled_houses(0, 10, 210, 220.4);
  first.holes.push_back(clockwise_box(212, 1.5, 0.8, 7));
  const Simplification result = simplified({first, box(214, 2, 4, 4)});
  ASSERT_EQ(result.members,
            (std::vector{indices_of<BuildingIndex>({0}), indices_of<BuildingIndex>({1})}));
  EXPECT_EQ(result.flags, (std::vector<std::uint32_t>{kRepaired, kRepaired}));
  // A little of the wall's ends stays with each.
  EXPECT_NEAR(area(result.footprints[0]), 100, 3);
  EXPECT_NEAR(area(result.footprints[1]), 104, 3);
  EXPECT_NEAR(result.stats.area_before, area(first), 0.01);
  EXPECT_NEAR(result.changes[1].symmetric_difference, 104 - 16, 3);
}

TEST(Simplify, OverlappingMembersThatArePartedCountOnce) {
  // The first and the second overlap by 4 m; the first is half a metre from the domain's boundary.
  const Polygon right{
      {{220, 5}, {420, 5}, {420, 0}, {432, 0}, {432, 10}, {420, 10}, {420, 5.2}, {220, 5.2}}, {}};
  const std::vector<Polygon> input =
      cleaned({walled_houses(0, 10, 210, 214), box(210, 0, 10, 10), right});
  const Bounds2 domain{-0.5, -20, 500, 40};
  const SimplifyOptions options;
  const Simplification result = simplify_footprints(input, domain, options);
  expect_sound(result, input.size(), domain, options);
  ASSERT_EQ(result.members,
            (std::vector{indices_of<BuildingIndex>({0}), indices_of<BuildingIndex>({1}),
                         indices_of<BuildingIndex>({2})}));
  EXPECT_EQ(result.flags, (std::vector<std::uint32_t>{kRepaired | kClipped, kRepaired, kRepaired}));
  EXPECT_NEAR(result.stats.area_before, 95 + 40 + 100 + 40 + 120, 0.02);
  // The two walls, and what of the second house is the first one's.
  EXPECT_NEAR(result.stats.symmetric_difference, 40 + 40 + 2 * 40, 10);
}

// --- random and real cities -------------------------------------------------------------------

std::vector<Polygon> random_boxes(std::mt19937& random, int count, double size, bool turn) {
  std::uniform_real_distribution<double> side(1, 20), place(0, size), angle(0, 3);
  std::vector<Polygon> result;
  for (int i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), w = side(random), h = side(random);
    result.push_back(turn ? turned(box(x, y, w, h), angle(random), {x, y}) : box(x, y, w, h));
  }
  return result;
}

TEST(Simplify, RandomBoxes) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    const Simplification result =
        simplified(random_boxes(random, 200, 150.0 + 30 * (trial % 12), trial % 2 == 0));
    EXPECT_LT(kept_change(result), 0.03 * result.stats.area_before);
  }
}

TEST(Simplify, RandomStarsAtSeveralDistances) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 200), size(2, 25);
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    std::vector<Polygon> input;
    for (int i = 0; i < 40; ++i)
      input.push_back(random_star(random, {place(random), place(random)}, size(random),
                                  3 + static_cast<int>(random() % 30)));
    SimplifyOptions options;
    options.min_distance =
        std::vector{0.05, 0.5, 1.0, 3.0, 10.0}[static_cast<std::size_t>(trial % 5)];
    simplified(input, options);
  }
}

TEST(Simplify, TangledRings) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 60);
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    Polygon tangle;
    for (int i = 0; i < 4 + trial; ++i) tangle.outer.push_back({place(random), place(random)});
    simplified({tangle, box(place(random), place(random), 10, 10)});
  }
}

/// The area by counting samples: independent of all geometry above.
double sampled_change(const std::vector<Polygon>& before, const std::vector<Polygon>& after,
                      const Bounds2& domain, double step) {
  std::int64_t differ = 0;
  for (double y = domain.ymin + step / 3; y < domain.ymax; y += step)
    for (double x = domain.xmin + step / 3; x < domain.xmax; x += step) {
      const auto inside = [&](const std::vector<Polygon>& polygons) {
        return std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) {
          return contains(polygon, {x, y});
        });
      };
      if (inside(before) != inside(after)) ++differ;
    }
  return static_cast<double>(differ) * step * step;
}

TEST(Simplify, StatesHowMuchItChanged) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  const std::vector<Polygon> input = cleaned(random_boxes(random, 60, 80, true));
  SimplifyOptions options;
  options.min_distance = 3;  // large, so that there is something to measure
  const Bounds2 domain = domain_around(input);
  const Simplification result = simplify_footprints(input, domain, options);
  const double sampled = sampled_change(input, result.footprints, domain, 0.1);
  EXPECT_GT(sampled, 50);
  EXPECT_NEAR(result.stats.symmetric_difference, sampled, 0.03 * sampled);
  double after = 0;
  for (const Polygon& polygon : result.footprints) after += area(polygon);
  EXPECT_NEAR(result.stats.area_after, after, 1e-6 * after);
}

TEST(Simplify, StatesTheLargestDistance) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  SimplifyOptions options;
  options.min_distance = 3;  // large, so that there is something to measure
  const std::vector<Polygon> input = cleaned(random_boxes(random, 60, 90, true));
  const Simplification result = simplify_footprints(input, domain_around(input), options);
  ASSERT_EQ(result.changes.size(), result.footprints.size());
  double largest = 0;
  for (std::size_t k = 0; k < result.footprints.size(); ++k) {
    std::vector<Polygon> before;
    for (const BuildingIndex m : result.members[k])
      before.push_back(input[static_cast<std::size_t>(m)]);
    const double sampled = sampled_distance(before, {result.footprints[k]}, 0.1);
    // Samples may miss the farthest place; they are never too far.
    EXPECT_LE(sampled, result.changes[k].hausdorff_distance + 0.02) << k;
    EXPECT_GE(sampled, result.changes[k].hausdorff_distance - 0.4) << k;
    largest = std::max(largest, result.changes[k].hausdorff_distance);
  }
  EXPECT_EQ(result.stats.max_hausdorff_distance, largest);
  EXPECT_GT(largest, 0.5);
}

TEST(Simplify, UnitesHugeClustersExactly) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  constexpr int size = 200;
  std::vector<std::uint8_t> covered(size * size, 0);
  std::vector<Polygon> input;
  const auto side = [&] { return 4 + static_cast<int>(random() % 9); };
  for (int i = 0; i < 1500; ++i) {
    const int w = side(), h = side(), x = static_cast<int>(random() % (size - 13)),
              y = static_cast<int>(random() % (size - 13));
    for (int v = y; v < y + h; ++v)
      for (int u = x; u < x + w; ++u) covered[static_cast<std::size_t>(v * size + u)] = 1;
    input.push_back(box(x, y, w, h));
  }
  const auto area = static_cast<double>(std::count(covered.begin(), covered.end(), 1));
  EXPECT_NEAR(simplified(input).stats.area_before, area, 1e-6);
}

struct RealCase {
  const char* path;
  const char* crs;
  std::int64_t groups;    ///< Blocks closer than 1 m, from the description of the data; 0 unknown.
  double largest_change;  ///< Of the area, without what is dropped.
  double distance;        ///< That 99 % of the buildings keep, metres: measured and a sixth more.
};

void PrintTo(const RealCase& real, std::ostream* out) { *out << real.path; }

std::vector<Polygon> read_local(const std::filesystem::path& path, const char* crs) {
  ReadFootprintsOptions options;
  options.target_crs = crs;
  const FootprintsInput input = read_footprints(path, options);
  const Point2 origin{std::floor(input.bounds.xmin), std::floor(input.bounds.ymin)};
  std::vector<Polygon> raw;
  for (const Footprint& feature : input.features) {
    Polygon polygon = feature.polygon;
    for (Point2& p : polygon.outer) p = {p.x - origin.x, p.y - origin.y};
    for (Ring& hole : polygon.holes)
      for (Point2& p : hole) p = {p.x - origin.x, p.y - origin.y};
    raw.push_back(std::move(polygon));
  }
  return raw;
}

class RealFootprints : public ::testing::TestWithParam<RealCase> {};

TEST_P(RealFootprints, KeepTheirShape) {
  TETROPOLIS_REQUIRE_DATA(path, GetParam().path);
  const Simplification result = simplified(read_local(path, GetParam().crs));
  if (GetParam().groups > 0) {
    EXPECT_EQ(result.stats.groups, GetParam().groups);
  }
  EXPECT_LT(kept_change(result), GetParam().largest_change * result.stats.area_before);
  std::vector<double> distances;
  for (const FootprintChange& change : result.changes)
    distances.push_back(change.hausdorff_distance);
  std::sort(distances.begin(), distances.end());
  EXPECT_LT(distances[(distances.size() * 99 + 99) / 100 - 1], GetParam().distance);
  const auto hulls = std::count_if(result.flags.begin(), result.flags.end(),
                                   [](std::uint32_t f) { return (f & kConvexHull) != 0; });
  EXPECT_LE(static_cast<double>(hulls), 0.005 * static_cast<double>(result.flags.size()));
}

INSTANTIATE_TEST_SUITE_P(
    Simplify, RealFootprints,
    ::testing::Values(RealCase{"delft_3dfier/footprints.shp", "", 28, 0.006, 0.7},
                      RealCase{"amsterdam_south/footprints.shp", "", 62, 0.005, 1.0},
                      RealCase{"dtcc_small/goteborg_by_14.shp", "", 0, 0.005, 1.2},
                      RealCase{"tudelft_campus_bag/footprints.shp", "", 0, 0.005, 1.15},
                      RealCase{"bielefeld_lod1_east/footprints.shp", "", 0, 0.005, 0.9},
                      RealCase{"alexandria_dsm_dtm/footprints.shp", "", 0, 0.005, 0.58},
                      RealCase{"boulder_wgs84/boulder_buildings.shp", "EPSG:32613", 0, 0.005,
                               0.63}));

TEST(Simplify, NeedsNoHullsForAmsterdamAtAnyDistance) {
  TETROPOLIS_REQUIRE_DATA(path, "amsterdam_south/footprints.shp");
  const std::vector<Polygon> input = read_local(path, "");
  for (const double distance : {0.5, 2.0, 3.0}) {
    SimplifyOptions options;
    options.min_distance = distance;
    const Simplification result = simplified(input, options);
    EXPECT_EQ(result.stats.hulls, 0) << distance;
    EXPECT_EQ(result.stats.local_hulls, 0) << distance;
  }
}

TEST(Simplify, DoesNotDependOnThreads) {
  std::mt19937 random(testing::test_seed());
  const std::vector<Polygon> input = cleaned(random_boxes(random, 1500, 600, true));
  const Bounds2 domain = domain_around(input);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return simplify_footprints(input, domain, {});
  };
  const Simplification one = run(1), four = run(4);
  EXPECT_EQ(one.footprints, four.footprints);
  EXPECT_EQ(one.members, four.members);
  EXPECT_EQ(one.flags, four.flags);
  EXPECT_EQ(one.stats.symmetric_difference, four.stats.symmetric_difference);
}

}  // namespace
}  // namespace tetropolis
