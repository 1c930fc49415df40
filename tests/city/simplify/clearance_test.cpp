#include "tetropolis/city/simplify/clearance.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/city_model.h"

#include "city/footprint_checks.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::brute_force_clearance;
using testing::clockwise_box;
using testing::random_star;

Polygon snapped(Polygon polygon) {
  for (Point2& p : polygon.outer) p = snap_coordinate(p);
  for (Ring& hole : polygon.holes)
    for (Point2& p : hole) p = snap_coordinate(p);
  return polygon;
}

TEST(JointClearance, OfASquareIsItsSide) {
  const std::vector<Polygon> one{box(0, 0, 7, 7)};
  EXPECT_DOUBLE_EQ(joint_clearance(one).distance, 7);
}

TEST(JointClearance, OfNothingIsInfinite) {
  EXPECT_TRUE(std::isinf(joint_clearance({}).distance));
  EXPECT_TRUE(std::isinf(joint_clearance({}, Bounds2{0, 0, 1, 1}).distance));
}

TEST(JointClearance, NamesTheClosestPair) {
  // A corner of the second, 0.5 m above the middle of the top edge of the first.
  const std::vector<Polygon> two{box(0, 0, 10, 10), {{{5, 10.5}, {9, 14}, {5, 18}, {1, 14}}, {}}};
  const Clearance clearance = joint_clearance(two);
  EXPECT_DOUBLE_EQ(clearance.distance, 0.5);
  EXPECT_EQ(clearance.vertex, (RingFeature{1, 0, 0}));
  EXPECT_EQ(clearance.other, (RingFeature{0, 0, 2}));
  EXPECT_EQ(clearance.at, (Point2{5, 10.5}));
}

TEST(JointClearance, SeesHolesAndTheDomain) {
  std::vector<Polygon> one{box(10, 10, 20, 20)};
  one[0].holes.push_back(clockwise_box(10.25, 15, 5, 5));
  EXPECT_DOUBLE_EQ(joint_clearance(one).distance, 0.25);
  const Clearance clearance = joint_clearance(one, Bounds2{0, 0, 30.125, 40});
  EXPECT_DOUBLE_EQ(clearance.distance, 0.125);
  EXPECT_EQ(clearance.other.polygon, -1);
  EXPECT_EQ(joint_clearance(one, Bounds2{0, 0, 29, 40}).distance, 0);
}

TEST(JointClearance, IsZeroWhereVerticesCoincide) {
  const std::vector<Polygon> two{box(0, 0, 10, 10), box(10, 10, 5, 5)};
  EXPECT_EQ(joint_clearance(two).distance, 0);
}

TEST(JointClearance, EqualsBruteForce) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-200, 200), size(0.5, 30);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Polygon> polygons;
    const int count = 1 + trial % 12;
    for (int i = 0; i < count; ++i) {
      Polygon polygon = random_star(random, {place(random), place(random)}, size(random),
                                    3 + static_cast<int>(random() % 12));
      if (i % 3 == 0) polygon.holes.push_back(clockwise_box(place(random), place(random), 3, 2));
      polygons.push_back(std::move(polygon));
    }
    const double expected = brute_force_clearance(polygons);
    const Clearance found = joint_clearance(polygons);
    EXPECT_EQ(found.distance, expected) << "trial " << trial;
    // The pair named is that close.
    const auto ring = [&](const RingFeature& f) -> const Ring& {
      const Polygon& p = polygons[static_cast<std::size_t>(f.polygon)];
      return f.ring == 0 ? p.outer : p.holes[static_cast<std::size_t>(f.ring - 1)];
    };
    const Ring& other = ring(found.other);
    const auto e = static_cast<std::size_t>(found.other.index);
    EXPECT_EQ(ring(found.vertex)[static_cast<std::size_t>(found.vertex.index)], found.at);
    EXPECT_EQ(distance_to_segment(found.at, other[e], other[(e + 1) % other.size()]), expected);
  }
}

std::vector<FootprintDefectKind> kinds(const std::vector<Polygon>& polygons) {
  std::vector<FootprintDefectKind> result;
  for (const FootprintDefect& defect : footprint_defects(polygons)) result.push_back(defect.kind);
  return result;
}

TEST(FootprintDefects, NoneInValidFootprints) {
  std::vector<Polygon> city{box(0, 0, 20, 20), box(5, 5, 4, 4), box(30, 0, 5, 5)};
  city[0].holes.push_back(clockwise_box(4, 4, 6, 6));
  city[0].holes.push_back(clockwise_box(12, 4, 6, 6));
  EXPECT_TRUE(footprint_defects(city).empty());
}

TEST(FootprintDefects, FindsEachKind) {
  EXPECT_EQ(kinds({{{{0, 0}, {1, 0}}, {}}}), std::vector{FootprintDefectKind::kTooFewVertices});
  EXPECT_EQ(kinds({{{{0, 0}, {1, 0}, {0, NAN}}, {}}}),
            std::vector{FootprintDefectKind::kNotFinite});
  EXPECT_EQ(kinds({{{{0, 0}, {1, 0}, {0, 1.00001}}, {}}}),
            std::vector{FootprintDefectKind::kOffGrid});
  EXPECT_EQ(kinds({{{{0, 0}, {0, 1}, {1, 0}}, {}}}),
            std::vector{FootprintDefectKind::kOrientation});
  Polygon hole_turned = box(0, 0, 9, 9);
  hole_turned.holes.push_back(box(2, 2, 3, 3).outer);
  EXPECT_EQ(kinds({hole_turned}), std::vector{FootprintDefectKind::kOrientation});
  // Crosses itself, though its area is positive.
  EXPECT_EQ(kinds({{{{0, 0}, {10, 0}, {10, 10}, {4, -2}}, {}}}),
            std::vector{FootprintDefectKind::kRingsTouch});
  // Turns back upon itself.
  EXPECT_FALSE(footprint_defects(
                   std::vector<Polygon>{{{{0, 0}, {10, 0}, {10, 5}, {10, 9}, {10, 5}, {0, 5}}, {}}})
                   .empty());
  // Two that share a corner only.
  EXPECT_FALSE(footprint_defects(std::vector{box(0, 0, 5, 5), box(5, 5, 5, 5)}).empty());
  EXPECT_EQ(kinds({box(0, 0, 20, 20), box(5, 5, 4, 4)}),
            std::vector{FootprintDefectKind::kPolygonsOverlap});
  Polygon hole_outside = box(0, 0, 9, 9);
  hole_outside.holes.push_back(clockwise_box(20, 2, 3, 3));
  EXPECT_EQ(kinds({hole_outside}), std::vector{FootprintDefectKind::kHoleOutside});
  Polygon hole_in_hole = box(0, 0, 20, 20);
  hole_in_hole.holes.push_back(clockwise_box(2, 2, 10, 10));
  hole_in_hole.holes.push_back(clockwise_box(4, 4, 3, 3));
  EXPECT_EQ(kinds({hole_in_hole}), std::vector{FootprintDefectKind::kHoleOutside});
}

TEST(FootprintDefects, NestingWhereEdgesMeetAtTheRay) {
  // The hole's leftmost vertex is level with a notch whose two edges start at one point.
  Polygon polygon{{{0, 0}, {20, 0}, {20, 10}, {8, 10}, {6, 5}, {4, 10}, {0, 10}}, {}};
  polygon.holes.push_back({{10, 5}, {12, 7}, {14, 5}, {12, 3}});
  EXPECT_TRUE(footprint_defects(std::vector{polygon}).empty());
}

TEST(FootprintDefects, AgreesWithBruteForceOnRandomPairs) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 12), size(1, 6);
  for (int trial = 0; trial < 500; ++trial) {
    const std::vector<Polygon> two{
        snapped(box(place(random), place(random), size(random), size(random))),
        snapped(box(place(random), place(random), size(random), size(random)))};
    const Bounds2 a = bounds(two[0]), b = bounds(two[1]);
    EXPECT_EQ(footprint_defects(two).empty(), !a.intersects(b)) << "trial " << trial;
  }
}

}  // namespace
}  // namespace tetropolis
