#include "city/clip.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "footprint_checks.h"

namespace tetropolis {
namespace {

using testing::box;

const Domain kDomain(0, 0, 100, 100);

TEST(Domain, PositionIsThatOfTheBoxOfWhatAreNumbers) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(kDomain.position_of(box(10, 10, 5, 5)), DomainPosition::kInside);
  EXPECT_EQ(kDomain.position_of(box(98, 10, 5, 5)), DomainPosition::kCrossing);
  EXPECT_EQ(kDomain.position_of(box(101, 10, 5, 5)), DomainPosition::kOutside);
  // An L around the corner of the domain: its box does what it does not.
  const Polygon l{{{90, 120}, {120, 120}, {120, 90}, {110, 90}, {110, 110}, {90, 110}}, {}};
  EXPECT_EQ(kDomain.position_of(l), DomainPosition::kCrossing);
  EXPECT_EQ(kDomain.position_of({{{10, 10}, {20, std::nan("")}, {20, 20}}, {}}),
            DomainPosition::kInside);
  EXPECT_EQ(kDomain.position_of({{{10, 10}, {20, inf}, {20, 20}}, {}}), DomainPosition::kCrossing);
  EXPECT_EQ(kDomain.position_of({}), DomainPosition::kInside);
}

TEST(ClipToDomain, KeepsAllPartsButSlivers) {
  // A U whose bottom is outside: arms of 30 m x 10 m and 20 m x 10 m are left.
  const Polygon u{
      {{50, -10}, {90, -10}, {90, 20}, {80, 20}, {80, -5}, {60, -5}, {60, 30}, {50, 30}}, {}};
  double lost = -1;
  const std::vector<Polygon> arms = clip_to_domain(u, kDomain, 15, &lost);
  ASSERT_EQ(arms.size(), 2U);
  EXPECT_NEAR(area(arms[0]), 300, 1e-9);
  EXPECT_NEAR(area(arms[1]), 200, 1e-9);
  EXPECT_EQ(lost, 0);
  const std::vector<Polygon> wide = clip_to_domain(u, kDomain, 201, &lost);
  ASSERT_EQ(wide.size(), 1U);
  EXPECT_NEAR(area(wide[0]), 300, 1e-9);
  EXPECT_NEAR(lost, 200, 1e-9);
  // The largest stays, however small.
  EXPECT_NEAR(area(clip_to_domain(box(-5, 0, 10, 10), kDomain, 60, &lost).at(0)), 50, 1e-9);
  EXPECT_EQ(lost, 0);
  EXPECT_NEAR(area(clip_to_domain(box(-9.9, 0, 10, 12), kDomain, 15, &lost).at(0)), 1.2, 1e-9);
  EXPECT_TRUE(clip_to_domain(box(-9.9, 0, 10, 8), kDomain, 15, &lost).empty());
  EXPECT_NEAR(lost, 0.8, 1e-9);
  EXPECT_NEAR(area(clip_to_domain(box(-9.9, 0, 10, 8), kDomain, 0, &lost).at(0)), 0.8, 1e-9);
  lost = -1;
  EXPECT_TRUE(clip_to_domain(box(200, 0, 10, 10), kDomain, 15, &lost).empty());
  EXPECT_EQ(lost, 0);
}

}  // namespace
}  // namespace tetropolis
