// How clusters become one polygon: every way, with areas known from drawing them.
#include "city/simplify/merge_polygons.h"

#include <cmath>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/geometry/polygon.h"

#include "city/footprint_checks.h"
#include "city/grid_geometry.h"
#include "city/simplify/overlay.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::kSliver;

/// The first reach of gap fills, in distances (merge_polygons).
constexpr double kReach = 1 + 1e-3;

struct MergeCase {
  const char* name;
  std::vector<Polygon> cluster;  ///< Metres.
  double distance = 1;           ///< Metres.
  int growths = 3;
  MergeMethod method;
  int growths_needed = 0;    ///< For kGapFill.
  std::size_t parts = 2;     ///< Of the union.
  double area = 0;           ///< Square metres.
  double tolerance = 1e-7;   ///< Of the area: ten steps by ten.
  std::size_t vertices = 0;  ///< Of the outer ring.
};

void PrintTo(const MergeCase& merge, std::ostream* out) { *out << merge.name; }

class MergeMethods : public ::testing::TestWithParam<MergeCase> {};

TEST_P(MergeMethods, JoinAClusterThatTheOnesBeforeDoNot) {
  const MergeCase& merge = GetParam();
  std::vector<Polygon> cluster;
  for (const Polygon& polygon : merge.cluster) cluster.push_back(grid::to_steps(polygon));
  const MergedPolygon merged =
      merge_polygons(cluster, merge.distance * grid::kSteps, merge.growths);
  EXPECT_EQ(merged.method, merge.method);
  if (merge.method == MergeMethod::kGapFill) {
    EXPECT_EQ(merged.growths, merge.growths_needed);
  }
  const Polygon result = grid::to_metres(merged.polygon);
  EXPECT_TRUE(footprint_defects({&result, 1}).empty());
  EXPECT_TRUE(result.holes.empty());
  EXPECT_EQ(result.outer.size(), merge.vertices);
  EXPECT_NEAR(area(result), merge.area, merge.tolerance);
  // The union is told as it is before anything is put between its parts, and nothing of it is lost.
  EXPECT_EQ(merged.input.size(), merge.parts);
  EXPECT_EQ(merged.input, unite_or_largest(cluster));
  for (const Polygon& lost : subtract_on_grid(merged.input, std::vector{merged.polygon}))
    EXPECT_LT(area(lost) / grid::kSquareMetre, 1e-7);
}

/// Two squares of 10 m whose corners are `gap` apart along x and along y.
std::vector<Polygon> corner_to_corner(double gap) {
  return {box(0, 0, 10, 10), box(10 + gap, 10 + gap, 10, 10)};
}

/// Between those, the walls as far as they are within `reach` of the other corner span two
/// triangles with legs of sqrt(reach^2 - gap^2), less the corners of the square of the gap.
double corner_fills(double reach, double gap) { return reach * reach - 2 * gap * gap; }

/// A sliver of 202 m that starts a millimetre wide and is a hundredth of that where it leaves what
/// ends at x = 200: its tip goes flat on the grid, and with it what joined this to what is next to
/// the tip. Only so do clusters get to the hulls: where two parts are closer than the distance, a
/// box wider than that across the narrowest place has area in common with both.

/// 200 m by 8 m below a slab of 220 m by 2 m: the sliver's tip is beside it and below the slab.
const Polygon kGallows{{{0, 0}, {200, 0}, {200, 8}, {220, 8}, {220, 10}, {0, 10}}, {}};

INSTANTIATE_TEST_SUITE_P(
    MergePolygons, MergeMethods,
    ::testing::Values(
        MergeCase{.name = "OneByItself",
                  .cluster = {box(0, 0, 10, 10)},
                  .method = MergeMethod::kUnion,
                  .parts = 1,
                  .area = 100,
                  .vertices = 4},
        MergeCase{.name = "Union",
                  .cluster = {box(0, 0, 10, 10), box(5, 5, 10, 10)},
                  .method = MergeMethod::kUnion,
                  .parts = 1,
                  .area = 175,
                  .vertices = 8},
        MergeCase{.name = "GapFillBetweenFacingWalls",
                  .cluster = {box(0, 0, 10, 10), box(10.5, 0, 10, 10)},
                  .method = MergeMethod::kGapFill,
                  .growths_needed = 1,
                  .area = 205,
                  .vertices = 8},
        // They touch in a point, which is no union yet.
        MergeCase{.name = "GapFillsAtACommonCorner",
                  .cluster = corner_to_corner(0),
                  .method = MergeMethod::kGapFill,
                  .growths_needed = 1,
                  .area = 200 + corner_fills(kReach, 0),
                  .vertices = 10},
        // At the first reach both gap fills are smaller than a square centimetre.
        MergeCase{.name = "GapFillsOfTwiceTheReach",
                  .cluster = corner_to_corner(0.0707),
                  .distance = 0.1,
                  .method = MergeMethod::kGapFill,
                  .growths_needed = 2,
                  .area = 200 + corner_fills(2 * 0.1 * kReach, 0.0707),
                  .tolerance = 2e-5,
                  .vertices = 10},
        // And that of two needles, 5 mm wide at a metre from their tips, at the second, too.
        MergeCase{.name = "GapFillsOfFourTimesTheReach",
                  .cluster = {{{{0, 9.9}, {40, 10}, {0, 10.1}}, {}},
                              {{{80.0999, 10.1}, {40.0999, 10}, {80.0999, 9.9}}, {}}},
                  .distance = 0.1,
                  .method = MergeMethod::kGapFill,
                  .growths_needed = 3,
                  .area = 8,
                  .tolerance = 0.01,
                  .vertices = 8},
        // A square of 1.1 distances in the middle between the corners.
        MergeCase{.name = "Bridge",
                  .cluster = corner_to_corner(0.0707),
                  .distance = 0.1,
                  .growths = 1,
                  .method = MergeMethod::kBridge,
                  .area = 200 + 0.11 * 0.11 - 2 * std::pow((0.11 - 0.0707) / 2, 2),
                  .tolerance = 2e-5,
                  .vertices = 12},
        // The hull of the gallows has the triangle of 20 m by 8 m below the arm as well, and half
        // of the box.
        MergeCase{.name = "UnionOfHulls",
                  .cluster = {kGallows, kSliver, box(202.5, 0, 10, 6)},
                  .method = MergeMethod::kUnionOfHulls,
                  .area = 2040 + 80 + 30,
                  .tolerance = 1e-3,
                  .vertices = 11},
        MergeCase{.name = "HullOfAll",
                  .cluster = {box(0, 0, 200, 10), kSliver, box(202.5, 0, 10, 10)},
                  .method = MergeMethod::kHull,
                  .area = 212.5 * 10,
                  .vertices = 4}),
    [](const ::testing::TestParamInfo<MergeCase>& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace tetropolis
