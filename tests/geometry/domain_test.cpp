#include "tetropolis/geometry/domain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

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

}  // namespace
}  // namespace tetropolis
