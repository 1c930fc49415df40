#include "tetropolis/geometry/domain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "support/errors.h"

namespace tetropolis {
namespace {

TEST(Domain, SidesAreTheOutlineWithTheDomainOnTheLeft) {
  const Domain domain(-3, 2, 7, 9);
  EXPECT_EQ(domain.area(), area(domain.outline()));
  const Ring ring = domain.outline().outer;
  const std::vector<Domain::Side> sides = domain.sides();
  ASSERT_EQ(sides.size(), ring.size());
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    EXPECT_EQ(sides[i].from, ring[i]);
    EXPECT_EQ(sides[i].to, ring[(i + 1) % ring.size()]);
    EXPECT_EQ(domain.distance_to_side(i, sides[i].from), 0);
    EXPECT_EQ(domain.distance_to_side(i, sides[i].to), 0);
    const Point2 inside{4, 3}, u{sides[i].to.x - sides[i].from.x, sides[i].to.y - sides[i].from.y};
    const double left = u.x * (inside.y - sides[i].from.y) - u.y * (inside.x - sides[i].from.x);
    EXPECT_NEAR(domain.distance_to_side(i, inside), left / std::hypot(u.x, u.y), 1e-12);
    patches.push_back(sides[i].patch);
  }
  EXPECT_EQ(patches, (std::vector{Patch::kYMin, Patch::kXMax, Patch::kYMax, Patch::kXMin}));
}

TEST(Domain, KnowsWhatIsInsideAndHowFarTheBoundaryIs) {
  const Domain domain(0, 0, 10, 6);
  EXPECT_EQ(domain.distance_to_boundary({4, 2}), 2);
  EXPECT_EQ(domain.distance_to_boundary({9.5, 2}), 0.5);
  EXPECT_EQ(domain.distance_to_boundary({10, 2}), 0);
  EXPECT_EQ(domain.distance_to_boundary({12, 2}), -2);
  EXPECT_TRUE(domain.contains({10, 2}));
  EXPECT_FALSE(domain.encloses({10, 2}));
  EXPECT_TRUE(domain.encloses({9.5, 2}));
  EXPECT_FALSE(domain.encloses({std::nan(""), 2}));
  EXPECT_FALSE(domain.encloses({std::numeric_limits<double>::infinity(), 2}));
  EXPECT_EQ(domain.inset(1), Domain(1, 1, 9, 5));
  EXPECT_TRUE(domain.inset(4).empty());
  EXPECT_EQ(domain.moved({2, -1}), Domain(2, -1, 12, 5));
  EXPECT_TRUE(domain.is_meshable());
  EXPECT_FALSE(Domain(0, 0, 0, 6).is_meshable());
  EXPECT_FALSE(Domain(0, 0, std::nan(""), 6).is_meshable());
  EXPECT_TRUE(domain.covers(domain.outline()));
  EXPECT_FALSE(domain.inset(0.1).covers(domain.outline()));
}

TEST(Domain, OfAPolygon) {
  // An L: the corner at (4, 3) looks inwards.
  const Ring ring{{0, 0}, {10, 0}, {10, 3}, {4, 3}, {4, 8}, {0, 8}};
  const auto patch = [](int number) { return static_cast<Patch>(number); };
  const Domain domain(ring, {patch(9), patch(9), patch(10), patch(10), patch(10), patch(11)},
                      {{patch(9), "a", PatchKind::kSide},
                       {patch(10), "b", PatchKind::kSide},
                       {patch(11), "c", PatchKind::kSide}});
  EXPECT_FALSE(domain.is_box());
  EXPECT_TRUE(Domain(0, 0, 1, 1).is_box());
  EXPECT_EQ(domain.area(), 50);
  EXPECT_EQ(domain.bounds(), (Bounds2{0, 0, 10, 8}));
  EXPECT_EQ(domain.sides()[5].patch, patch(11));
  EXPECT_EQ(domain.sides()[5].to, (Point2{0, 0}));
  EXPECT_EQ(domain.outline().outer, ring);
  EXPECT_TRUE(domain.encloses({3, 7}));
  EXPECT_FALSE(domain.encloses({6, 6}));
  EXPECT_FALSE(domain.encloses({4, 5}));
  EXPECT_TRUE(domain.contains({4, 5}));
  EXPECT_EQ(domain.distance_to_boundary({2, 4}), 2);
  EXPECT_EQ(domain.distance_to_boundary({6, 5}), -2);
  EXPECT_EQ(domain.distance_to_side(1, {4, 1}), 6);
  EXPECT_EQ(domain.position_of(rectangle({1, 1, 3, 6})), DomainPosition::kInside);
  EXPECT_EQ(domain.position_of(rectangle({1, 1, 6, 6})), DomainPosition::kCrossing);
  EXPECT_EQ(domain.position_of(rectangle({20, 1, 26, 6})), DomainPosition::kOutside);
  // All corners are inside, and so is a corner of the domain.
  EXPECT_EQ(domain.position_of({{{1, 7}, {1, 1}, {9, 1}, {9, 2}, {3.5, 7}}, {}}),
            DomainPosition::kCrossing);
  const Domain moved = domain.moved({100, 50});
  EXPECT_EQ(moved.sides()[0].from, (Point2{100, 50}));
  EXPECT_EQ(moved.bounds(), domain.bounds().moved({100, 50}));
  EXPECT_NE(moved, domain);
}

TEST(Domain, OfAPolygonHasAPatchForEachSide) {
  const Ring ring{{0, 0}, {10, 0}, {10, 8}};
  const auto make = [](const Ring& sides, std::size_t patches) {
    return testing::error_of([&] { Domain(sides, std::vector<Patch>(patches, Patch::kXMin), {}); },
                             ErrorKind::kUsage);
  };
  EXPECT_EQ(make(ring, 3), "");
  EXPECT_EQ(make(ring, 2), "domain: 2 patches for 3 sides; give a patch for each of three or more");
  EXPECT_NE(make({}, 0), "");
}

}  // namespace
}  // namespace tetropolis
