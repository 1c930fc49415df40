#include "city/simplify/hausdorff_distance.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_checks.h"
#include "city/grid_geometry.h"
#include "city/simplify/symmetric_difference.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::circle;
using testing::clockwise_box;

struct Difference {
  double area = 0;      ///< Square metres.
  double distance = 0;  ///< Metres.
  Point2 at;
};

/// Of regions in metres.
Difference difference(const std::vector<Polygon>& before, const std::vector<Polygon>& after) {
  std::vector<Polygon> from, to;
  for (const Polygon& polygon : before) from.push_back(grid::to_steps(polygon));
  for (const Polygon& polygon : after) to.push_back(grid::to_steps(polygon));
  std::vector<DifferenceStrip> strips;
  const double area = symmetric_difference_area(from, to, &strips);
  const HausdorffDistance far = hausdorff_distance(from, to, strips, 0.01 * grid::kSteps);
  return {area / (grid::kSteps * grid::kSteps), far.distance / grid::kSteps,
          grid::to_metres(far.at)};
}

/// The mirror image at the line x = y.
std::vector<Polygon> mirrored(std::vector<Polygon> polygons) {
  const auto mirror = [](Ring& ring) {
    for (Point2& p : ring) std::swap(p.x, p.y);
    std::reverse(ring.begin(), ring.end());
  };
  for (Polygon& polygon : polygons) for_each_ring(polygon, mirror);
  return polygons;
}

/// The same both ways, and lying on the side: areas are swept along the longer one.
Difference expect_distance(const std::vector<Polygon>& before, const std::vector<Polygon>& after,
                           double area, double distance) {
  const Difference there = difference(before, after), back = difference(after, before);
  const Difference aside = difference(mirrored(before), mirrored(after));
  for (const Difference& d : {there, back, aside}) {
    EXPECT_NEAR(d.area, area, 1e-3 * area + 1e-3);
    EXPECT_NEAR(d.distance, distance, 0.011);
  }
  return there;
}

double strip_area(const DifferenceStrip& s) {
  return std::abs(signed_area(Ring(s.corners.begin(), s.corners.end())));
}

TEST(LargestDistance, StripsOfRingsInsideEachOtherAreTheDifference) {
  // Thirty rings one in the other become one disc. Were each strip to go on through the rings
  // inside it, these would be searched thirty times.
  constexpr int kRings = 30;
  std::vector<Polygon> rings;
  double gaps = 0;  // square steps
  for (int k = 0; k < kRings; ++k) {
    Polygon ring = grid::to_steps(circle({100, 100}, 90 - 2 * k, 60));
    const Polygon yard = grid::to_steps(circle({100, 100}, 89 - 2 * k, 60));
    gaps += area(yard);
    if (k > 0) gaps -= area(ring);
    ring.holes = {Ring(yard.outer.rbegin(), yard.outer.rend())};
    rings.push_back(ring);
  }
  const std::vector<Polygon> disc{{rings[0].outer, {}}};
  std::vector<DifferenceStrip> strips;
  EXPECT_NEAR(symmetric_difference_area(rings, disc, &strips), gaps, 1e-9 * gaps);
  double sum = 0;
  for (const DifferenceStrip& strip : strips) sum += strip_area(strip);
  EXPECT_NEAR(sum, gaps, 1e-9 * gaps);
  const HausdorffDistance far = hausdorff_distance(rings, disc, strips, 0.01 * grid::kSteps);
  EXPECT_NEAR(far.distance / grid::kSteps, (91 - 2 * kRings) * std::cos(std::acos(-1) / 60), 0.011);
}

TEST(LargestDistance, RingsInsideEachOther) {
  // Nothing of the inner box differs. Splitting it down to a centimetre would take for ever.
  expect_distance({box(0, 0, 1000, 800)}, {box(0.5, 0.5, 999, 799)}, 1799, std::sqrt(0.5));
  expect_distance({circle({500, 500}, 400, 90)}, {circle({500, 500}, 399.5, 90)},
                  std::acos(-1) * (400.0 * 400 - 399.5 * 399.5), 0.5);
  // A box within a box within a box.
  expect_distance({box(0, 0, 100, 100)},
                  {{box(10, 10, 80, 80).outer, {clockwise_box(20, 20, 60, 60)}}}, 3600 + 3600, 30);
}

TEST(LargestDistance, BlocksWithCracksBetweenThem) {
  // What differs is as thin as the tolerance; the blocks' inside must not be split down to that.
  std::vector<Polygon> blocks;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) blocks.push_back(box(2.01 * i, 2.01 * j, 2, 2));
  const double side = 2.01 * 30 - 0.01;
  expect_distance(blocks, {box(0, 0, side, side)}, side * side - 900 * 4, 0.005 * std::sqrt(2.0));
}

TEST(LargestDistance, CourtyardsInsideEachOther) {
  const Ring outer = box(0, 0, 60, 60).outer;
  const Polygon narrow{outer, {clockwise_box(20, 20, 20, 20)}};
  const Polygon wide{outer, {clockwise_box(19.5, 19.5, 21, 21)}};
  // Between the walls of the two courtyards, not in the middle of the courtyard.
  expect_distance({narrow}, {wide}, 41, 0.5);
  const Polygon round{outer, {circle({30, 30}, 8, 64).outer}};
  Polygon turned_round = round;
  std::reverse(turned_round.holes[0].begin(), turned_round.holes[0].end());
  expect_distance({turned_round}, {wide}, 441 - area({round.holes[0], {}}),
                  10.5 - 8 * std::sqrt(0.5));
}

TEST(LargestDistance, SomethingInACourtyard) {
  const Ring outer = box(0, 0, 60, 60).outer;
  const Polygon ring{outer, {clockwise_box(10, 10, 40, 40)}};
  // The middle of the side of the pavilion farthest from the ring's walls.
  const Difference d = expect_distance({ring}, {ring, box(20, 20, 20, 20)}, 400, 20);
  EXPECT_NEAR(d.at.x, 30, 0.03);
  EXPECT_NEAR(d.at.y, 30, 0.03);
  expect_distance({ring}, {{outer, {}}}, 1600, 20);
}

TEST(LargestDistance, PolygonsThatTouchInAPoint) {
  // The box stands with a corner in the notch of the other: what is inside that one, nearest to the
  // notch, is not outside because it is outside the box.
  const Polygon notched{{{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}}, {}};
  const Polygon bevelled{{{3, 3}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}}, {}};
  const Polygon diamond{{{10, 10}, {17, 13}, {20, 20}, {13, 17}}, {}};
  expect_distance({diamond, notched}, {diamond, bevelled}, area(notched) - area(bevelled),
                  std::sqrt(18.0));
}

/// From the tip of the arm that was cut off, the wall found first is not the nearest one.
TEST(LargestDistance, ToTheNearestWallFromOutsideOfTheBox) {
  const Polygon house{
      {{84.0738, 87.7960}, {90.4578, 96.3888}, {76.7018, 106.6087}, {70.3178, 98.0159}}, {}};
  const Polygon arm{
      {{81.8848, 85.6719}, {81.7804, 86.9262}, {68.2220, 85.7981}, {68.3264, 84.5438}}, {}};
  Polygon joined = house;
  joined.outer.insert(joined.outer.begin(), {81.8168, 85.6139});
  joined.outer.insert(joined.outer.end(), {{81.2482, 89.8953}, {78.8783, 86.6847}});
  EXPECT_NEAR(difference({house, arm}, {joined}).distance, 10.767, 0.01);
}

TEST(LargestDistance, NothingIsFarFromNothing) {
  EXPECT_EQ(difference({}, {box(0, 0, 10, 10)}).distance, 0);
  EXPECT_EQ(difference({box(0, 0, 10, 10)}, {}).distance, 0);
  EXPECT_NEAR(difference({box(0, 0, 10, 10)}, {}).area, 100, 1e-9);
}

}  // namespace
}  // namespace tetropolis
