// Slots and courtyards that lead nowhere are filled, passages stay.
#include "city/simplify/close_gaps.h"

#include <cstddef>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_checks.h"
#include "city/grid_geometry.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::clockwise_box;
using testing::turned;

/// Square metres that are filled.
double filled(const Polygon& polygon, double width) {
  double sum = 0;
  const Polygon on_grid = grid::to_steps(polygon);
  for (const Polygon& fill : dead_end_fills(on_grid, width * grid::kSteps))
    sum += area(fill) / grid::kSquareMetre;
  return sum;
}

/// 30 m by 20 m with a slot of 2 m by 12 m, which begins 10 m from the left.
Polygon block_with_slot() {
  return {{{0, 0}, {30, 0}, {30, 20}, {12, 20}, {12, 8}, {10, 8}, {10, 20}, {0, 20}}, {}};
}

constexpr double kFilm = 0.02;  // Fills overlap the walls, by half a millimetre.

TEST(CloseGaps, FillsASlotThatIsNarrower) {
  for (const double angle : {0.0, 0.3, 1.0, 2.5}) {
    SCOPED_TRACE(angle);
    const Polygon block = turned(block_with_slot(), angle);
    EXPECT_NEAR(filled(block, 3), 24, kFilm);
    EXPECT_NEAR(filled(block, 2.01), 24, kFilm);
    EXPECT_EQ(filled(block, 1.99), 0);
  }
}

TEST(CloseGaps, WallsOfUnequalLengthMakeASlotAsLongAsTheShorter) {
  Polygon block = block_with_slot();
  for (Point2& p : block.outer)
    if (p.y == 20 && p.x < 11) p.y = 15;
  EXPECT_NEAR(filled(block, 3), 14, kFilm);
}

TEST(CloseGaps, NarrowCourtyardsAreFilledAndWideOnesStay) {
  Polygon block = box(0, 0, 40, 20);
  block.holes = {clockwise_box(5, 5, 2, 10), clockwise_box(20, 5, 10, 10)};
  EXPECT_NEAR(filled(block, 3), 20, kFilm);
}

TEST(CloseGaps, APassageIntoACourtyardStays) {
  const Polygon ring{{{0, 0},
                      {30, 0},
                      {30, 30},
                      {16, 30},
                      {16, 20},
                      {20, 20},
                      {20, 10},
                      {10, 10},
                      {10, 20},
                      {14, 20},
                      {14, 30},
                      {0, 30}},
                     {}};
  EXPECT_EQ(filled(ring, 3), 0);
}

TEST(CloseGaps, CornersStay) {
  EXPECT_EQ(filled(box(0, 0, 10, 10), 3), 0);
  // An L and a plus have corners that no disc reaches.
  EXPECT_EQ(filled({{{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}}, {}}, 5), 0);
}

/// No more of slots is left than this share of the area, and all else is as of any simplification.
void expect_closed(const std::vector<Polygon>& raw, double width, double share = 1e-6) {
  const std::vector<Polygon> input = testing::cleaned(raw);
  const Bounds2 domain = testing::domain_around(input);
  SimplifyOptions options;
  options.close_gaps = width;
  const Simplification result = simplify_footprints(input, domain, options);
  testing::expect_sound(result, input.size(), domain, options);
  double left = 0, all = 0;
  for (const Polygon& polygon : result.footprints) {
    left += filled(polygon, width);
    all += area(polygon);
  }
  EXPECT_LE(left, share * all);
}

TEST(CloseGaps, SimplifiedFootprintsHaveNoSlotsLeft) {
  expect_closed({block_with_slot(), turned(block_with_slot(), 0.5, {100, 0})}, 3);
  // Two houses that touch leave a slot between their wings.
  expect_closed({{{{0, 0}, {12, 0}, {12, 6}, {8, 6}, {8, 20}, {0, 20}}, {}},
                 {{{12, 0}, {24, 0}, {24, 20}, {10, 20}, {10, 6}, {12, 6}}, {}}},
                3);
  std::mt19937 random(testing::test_seed());
  std::vector<Polygon> stars;
  for (int i = 0; i < 40; ++i)
    stars.push_back(testing::random_star(random, {60.0 * (i % 8), 60.0 * (i / 8)}, 25, 20));
  expect_closed(stars, 4, 5e-3);  // Repairs of such corners leave new ones.
}

TEST(CloseGaps, UpToTheMergeDistanceChangesNothing) {
  SCOPED_TRACE(testing::test_seed());
  SimplifyOptions plain, same, more;
  same.close_gaps = 1;
  more.close_gaps = 3;
  std::mt19937 random(testing::test_seed());
  std::vector<Polygon> raw{block_with_slot()};
  for (int i = 1; i < 40; ++i)
    raw.push_back(testing::random_star(random, {60.0 * (i % 8), 60.0 * (i / 8)}, 25, 20));
  const std::vector<Polygon> input = testing::cleaned(raw);
  const Bounds2 domain = testing::domain_around(input);
  const std::vector<Polygon> before = simplify_footprints(input, domain, plain).footprints;
  EXPECT_EQ(simplify_footprints(input, domain, same).footprints, before);
  EXPECT_NE(simplify_footprints(input, domain, more).footprints, before);
}

}  // namespace
}  // namespace tetropolis
