#include "tetropolis/city/clean.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/io/vector/vector.h"

#include "footprint_checks.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::circle;
using testing::clockwise_box;

Polygon clean(const Polygon& raw, bool repaired = false) {
  const CleanedFootprint result = clean_footprint(raw);
  EXPECT_EQ(result.reason, "");
  EXPECT_EQ(result.repaired, repaired);
  for (const FootprintDefect& defect : footprint_defects(std::vector{result.polygon}))
    ADD_FAILURE() << defect.message;
  EXPECT_EQ(clean_footprint(result.polygon).polygon, result.polygon);
  return result.polygon;
}

double max_distance(const Polygon& from, const Polygon& to) {
  double most = 0;
  for (const Point2 p : from.outer) most = std::max(most, distance_to_boundary(to, p));
  return most;
}

TEST(CleanFootprint, KeepsACleanOne) { EXPECT_EQ(clean(box(1, 2, 10, 5)), box(1, 2, 10, 5)); }

TEST(CleanFootprint, OpensOrientsAndSnaps) {
  const Polygon closed_clockwise{{{0, 0}, {0, 5.00003}, {10, 5}, {10, 0}, {0, 0}}, {}};
  EXPECT_EQ(clean(closed_clockwise).outer, (Ring{{0, 0}, {10, 0}, {10, 5}, {0, 5}}));
  Polygon with_hole = box(0, 0, 20, 20);
  with_hole.holes.push_back(box(5, 5, 5, 5).outer);
  EXPECT_LT(signed_area(clean(with_hole).holes.at(0)), 0);
}

TEST(CleanFootprint, DropsDuplicatesSpikesAndParallels) {
  const Polygon raw{{{0, 0},
                     {0, 0},
                     {5, 0.0},
                     {5.0004, 0.0},  // nearly the same
                     {10, 0.01},     // on a line up to 1 cm
                     {20, 0},
                     {20, 10},
                     {20, 30},  // a spike of no width
                     {20, 10},
                     {0, 10}},
                    {}};
  EXPECT_EQ(clean(raw), box(0, 0, 20, 10));
}

TEST(CleanFootprint, ParallelToleranceIsAnAngle) {
  // Bends of 2 cm on 20 m either side (0.002 rad) go, of 4 m on 20 m stay.
  EXPECT_EQ(clean({{{0, 0}, {20, -0.019}, {40, 0}, {40, 10}, {0, 10}}, {}}).outer.size(), 4U);
  EXPECT_EQ(clean({{{0, 0}, {20, -4}, {40, 0}, {40, 10}, {0, 10}}, {}}).outer.size(), 5U);
  // A right angle of 1 cm is not parallel.
  EXPECT_EQ(clean({{{0, 0}, {5, 0}, {5, 0.01}, {10, 0.01}, {10, 5}, {0, 5}}, {}}).outer.size(), 6U);
}

TEST(CleanFootprint, FineCirclesStayWhereTheyAre) {
  for (const double radius : {1.0, 50.0, 1000.0}) {
    const Polygon raw = circle({3, 4}, radius, 4000);
    const Polygon result = clean(raw);
    EXPECT_GE(result.outer.size(), 100U) << radius;
    EXPECT_LE(result.outer.size(), 2000U) << radius;
    EXPECT_LE(max_distance(raw, result), kMaxOutlineShift) << radius;
    EXPECT_NEAR(area(result) / area(raw), 1, 1e-3) << radius;
  }
}

TEST(CleanFootprint, JoinsTheHalvesOfABowTie) {
  const Polygon result = clean({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}, {}}, true);
  EXPECT_NEAR(area(result), 50, 0.1);
}

TEST(CleanFootprint, KeepsTheLargestOfPartsThatAreApart) {
  // A ring that runs out to a second square and back on the same line.
  const Polygon raw{{{0, 0},
                     {10, 0},
                     {10, 5},
                     {20, 5},
                     {20, 0},
                     {22, 0},
                     {22, 6},
                     {20, 6},
                     {20, 5},
                     {10, 5},
                     {10, 10},
                     {0, 10}},
                    {}};
  const Polygon result = clean(raw, true);
  EXPECT_NEAR(area(result), 100, 0.1);
  EXPECT_NEAR(clean_footprint(raw).lost_area, 12, 0.1);
}

TEST(CleanFootprint, LosesNothingWherePartsAreJoined) {
  EXPECT_EQ(clean_footprint(box(0, 0, 10, 10)).lost_area, 0);
  EXPECT_LT(clean_footprint({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}, {}}).lost_area, 0.01);
}

/// What a wall may shift by counts from the outline given, so a bent one may go on shifting.
TEST(CleanFootprint, EachCleaningKeepsWithinTheShift) {
  const Polygon bent{
      {{0, 0}, {8, 0.011}, {16, 0.028}, {24, 0.017}, {32, 0.046}, {40, 0.038}, {40, 20}, {0, 20}},
      {}};
  const Polygon once = clean_footprint(bent).polygon, twice = clean_footprint(once).polygon;
  EXPECT_EQ(once.outer.size(), 5U);
  EXPECT_EQ(twice.outer.size(), 4U);
  EXPECT_LE(max_distance(bent, once), kMaxOutlineShift);
  EXPECT_LE(max_distance(once, twice), kMaxOutlineShift);
  EXPECT_EQ(clean_footprint(twice).polygon, twice);
}

TEST(CleanFootprint, ResolvesRingsThatTouch) {
  // Self-touching outer ring around a courtyard that touches it in a point.
  const Polygon keyhole{{{0, 0}, {10, 0}, {10, 10}, {5, 10}, {7, 5}, {3, 5}, {5, 10}, {0, 10}}, {}};
  EXPECT_NEAR(area(clean(keyhole, true)), 90, 0.1);
  Polygon hole_at_corner = box(0, 0, 10, 10);
  hole_at_corner.holes.push_back({{0, 0}, {3, 5}, {5, 3}});
  EXPECT_NEAR(area(clean(hole_at_corner, true)), 100 - 8, 0.1);
  Polygon hole_across = box(0, 0, 10, 10);
  hole_across.holes.push_back(clockwise_box(8, 4, 6, 2));
  EXPECT_NEAR(area(clean(hole_across, true)), 96, 0.1);
  Polygon hole_outside = box(0, 0, 10, 10);
  hole_outside.holes.push_back(clockwise_box(20, 4, 6, 2));
  EXPECT_NEAR(area(clean(hole_outside, true)), 100, 0.1);
  Polygon overlapping_holes = box(0, 0, 20, 20);
  overlapping_holes.holes.push_back(clockwise_box(2, 2, 6, 6));
  overlapping_holes.holes.push_back(clockwise_box(5, 5, 6, 6));
  EXPECT_NEAR(area(clean(overlapping_holes, true)), 400 - 63, 0.1);
}

TEST(CleanFootprint, SaysWhyAFootprintIsUnusable) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(clean_footprint({}).reason, "fewer than 3 distinct vertices");
  EXPECT_EQ(clean_footprint({{{0, 0}, {1, 1}, {0, 0}, {1, 1}}, {}}).reason,
            "fewer than 3 distinct vertices");
  EXPECT_EQ(clean_footprint({{{0, 0}, {5, 5}, {9, 9}}, {}}).reason, "zero area");
  EXPECT_EQ(clean_footprint({{{0, 0}, {NAN, 1}, {1, 0}}, {}}).reason, "non-finite coordinate");
  EXPECT_EQ(clean_footprint({{{0, 0}, {inf, 1}, {1, 0}}, {}}).reason, "non-finite coordinate");
  EXPECT_EQ(clean_footprint({{{0, 0}, {1e300, 1}, {1, 0}}, {}}).reason, "coordinate beyond 1e9 m");
  Polygon bad_hole = box(0, 0, 10, 10);
  bad_hole.holes.push_back({{1, 1}, {2, NAN}, {2, 1}});
  EXPECT_EQ(clean_footprint(bad_hole).reason, "non-finite coordinate");
}

TEST(CleanFootprint, ScribblesAreNoOutlines) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> along(0, 100);
  Polygon scribble;
  for (int i = 0; i < 1500; ++i) scribble.outer.push_back({along(random), along(random)});
  const CleanedFootprint cleaned = clean_footprint(scribble);
  EXPECT_FALSE(cleaned.usable());
  EXPECT_NE(cleaned.reason.find("crosses itself"), std::string::npos) << cleaned.reason;
}

TEST(CleanFootprint, SurvivesRandomRings) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  int usable = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    // From a coarse grid, so that vertices coincide and edges overlap.
    const int range = 2 + trial % 9;
    const double step = trial % 2 == 0 ? 1.0 : 0.0003;
    const auto ring = [&](int n) {
      Ring r;
      for (int i = 0; i < n; ++i)
        r.push_back({step * static_cast<double>(random() % static_cast<unsigned>(range)),
                     step * static_cast<double>(random() % static_cast<unsigned>(range))});
      return r;
    };
    Polygon raw{ring(3 + trial % 20), {}};
    if (trial % 4 == 0) raw.holes = {ring(4), ring(5)};
    const CleanedFootprint result = clean_footprint(raw);
    if (!result.usable()) continue;
    ++usable;
    const auto defects = footprint_defects(std::vector{result.polygon});
    EXPECT_TRUE(defects.empty()) << "trial " << trial << ": " << defects[0].message;
  }
  EXPECT_GT(usable, 500);
}

TEST(CleanFootprint, RealFootprints) {
  TETROPOLIS_REQUIRE_DATA(path, "boulder_wgs84/boulder_buildings.shp");
  ReadFootprintsOptions options;
  options.target_crs = "EPSG:32613";
  const FootprintsInput input = read_footprints(path, options);
  int repaired = 0;
  for (const Footprint& feature : input.features) {
    const CleanedFootprint result = clean_footprint(feature.polygon);
    ASSERT_TRUE(result.usable()) << feature.source_id << ": " << result.reason;
    ASSERT_TRUE(footprint_defects(std::vector{result.polygon}).empty()) << feature.source_id;
    if (result.repaired) {
      ++repaired;
    } else {
      ASSERT_LE(max_distance(feature.polygon, result.polygon), kMaxOutlineShift);
    }
    EXPECT_EQ(clean_footprint(result.polygon).polygon, result.polygon) << feature.source_id;
  }
  EXPECT_EQ(repaired, 10);  // what the description of the data says
}

/// One hole is the shell once more; the courtyard beside it is one all the same.
TEST(CleanFootprint, AHoleEqualToTheShellTakesNoCourtyardWithIt) {
  const Ring shell{{0, 0}, {40, 0}, {40, 40}, {0, 40}};
  const Ring courtyard{{10, 10}, {10, 20}, {20, 20}, {20, 10}};
  using Holes = std::vector<Ring>;
  for (const Holes& holes : {Holes{shell, courtyard}, Holes{courtyard, shell}, Holes{shell}}) {
    const CleanedFootprint clean = clean_footprint({shell, holes});
    ASSERT_TRUE(clean.usable());
    EXPECT_TRUE(clean.repaired);
    EXPECT_NEAR(area(clean.polygon), holes.size() == 1 ? 1600 : 1500, 1e-6);
  }
}

}  // namespace
}  // namespace tetropolis
