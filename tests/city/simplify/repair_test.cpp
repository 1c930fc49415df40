// Repair of outlines on its own.
#include "city/simplify/repair.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_checks.h"
#include "city/grid_geometry.h"

namespace tetropolis {
namespace {

using testing::box;

/// A triangular yard whose corners are half a metre from the outer walls, and a house in it a metre
/// from its walls: whichever corner moved away from the outer wall, the yard's walls would come too
/// close to the house. The outer walls are at the boundary.
TEST(Repair, YardsWithSomethingInThemAreNotFilled) {
  const double epsilon = 1.0 * grid::kSteps;
  Polygon block = box(0, 0, 21, 21);
  block.holes.push_back({{0.5, 0.5}, {10.5, 20.5}, {20.5, 0.5}});
  const Polygon house{{{2.15, 1.52}, {18.85, 1.52}, {10.5, 18.2}}, {}};
  for (const bool occupied : {true, false}) {
    SCOPED_TRACE(occupied);
    const Polygon outer = grid::to_steps(block), inner = grid::to_steps(house);
    std::vector<const Polygon*> polygons{&outer};
    if (occupied) polygons.push_back(&inner);
    Outline outline = make_outline(polygons, 4 * epsilon);
    RepairOptions options;
    options.epsilon = epsilon;
    options.max_cost = std::numeric_limits<double>::infinity();
    options.keep_inside = bounds(outer);
    RepairCounts counts;
    repair_vertices(outline, options, counts);
    EXPECT_EQ(counts.filled, 0);
    EXPECT_EQ(extract_polygon(outline, OutlineRing(0), 2).holes.size(), 1U);
    EXPECT_EQ(counts.moved > 0, !occupied);
  }
}

}  // namespace
}  // namespace tetropolis
