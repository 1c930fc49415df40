// Gap fills of outlines, and how many they are.
#include "city/simplify/gap_fill.h"

#include <gtest/gtest.h>

#include "city/grid_geometry.h"

namespace tetropolis {
namespace {

/// A back with teeth of 20 m, each `pitch` from the next and half as wide.
Polygon comb(int teeth, double pitch) {
  Polygon polygon{{{0, -5}, {teeth * pitch, -5}}, {}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double x = i * pitch;
    polygon.outer.insert(polygon.outer.end(),
                         {{x + pitch, 20}, {x + pitch / 2, 20}, {x + pitch / 2, 0}, {x, 0}});
  }
  return grid::to_steps(polygon);
}

TEST(GapFill, DoNotGrowWithTheSquareOfTheWallsThatCrowd) {
  const double epsilon = 1.0 * grid::kSteps;
  for (const double pitch : {0.4, 0.1, 0.05}) {
    SCOPED_TRACE(pitch);
    const Polygon crowd = comb(100, pitch);
    const Outline outline = make_outline({&crowd}, 4 * epsilon);
    const std::vector<NearPair> pairs = near_pairs(outline, epsilon);
    const std::vector<FillsAndCuts> repairs = fills_and_cuts(outline, pairs, epsilon, epsilon);
    const auto vertices = outline.point.size();
    ASSERT_EQ(repairs.size(), 1u);
    EXPECT_FALSE(repairs[0].fill.empty());
    // Every pair may give a gap fill for both walls at its vertex.
    EXPECT_LE(repairs[0].fill.size() + repairs[0].cut.size(), 30 * vertices);
    if (pitch < 0.1) {
      EXPECT_GT(pairs.size(), 40 * vertices);
    }
  }
}

}  // namespace
}  // namespace tetropolis
