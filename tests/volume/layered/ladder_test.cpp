#include "volume/layered/ladder.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

TEST(Ladder, GrowsFromTheFirstLayerToThoseOfTheCanopyAndAbove) {
  const LadderSpacing spacing{1.2, 1.2, 4, 20};
  for (const double top : {60.0, 131.0, 400.0})
    for (const double roofs : {3.0, 25.0}) {
      const std::vector<double> z = make_ladder(3, roofs, top, spacing);
      ASSERT_GT(z.size(), 3U);
      EXPECT_EQ(z.front(), 3);
      EXPECT_EQ(z.back(), top);
      const double stretch = (z[1] - z[0]) / spacing.first;  // of all alike
      EXPECT_NEAR(stretch, 1, 0.5 * spacing.far / (top - 3));
      for (std::size_t k = 1; k < z.size(); ++k) {
        const double height = z[k] - z[k - 1];
        EXPECT_GT(height, 0);
        EXPECT_LE(height, stretch * (z[k - 1] < roofs ? spacing.canopy : spacing.far) + 1e-9);
        const double below = k > 1 ? z[k - 1] - z[k - 2] : height;
        EXPECT_LE(height / below, 1.2 + 1e-9);
      }
    }
}

TEST(Ladder, HasTwoLayersAtLeast) {
  EXPECT_GE(make_ladder(0, 0, 2, {5, 1.2, 5, 20}).size(), 3U);
  EXPECT_EQ(make_ladder(0, 1, 2, {5, 1.2, 5, 20}).back(), 2);
}

}  // namespace
}  // namespace tetropolis
