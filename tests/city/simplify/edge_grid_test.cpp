#include "city/edge_grid.h"

#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "city/grid_geometry.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

struct Segment {
  Point2 a, b;
};

class EdgeGrids : public ::testing::Test {
 protected:
  Point2 point() { return {coordinate_(random_), coordinate_(random_)}; }
  /// Short, long, level, upright, without length; some of them outside of the grid.
  Segment segment() {
    const Point2 a = point();
    const Point2 b = point();
    switch (random_() % 5) {
      case 0:
        return {a, {a.x + b.x / 50, a.y + b.y / 50}};
      case 1:
        return {a, {b.x, a.y}};
      case 2:
        return {a, {a.x, b.y}};
      case 3:
        return {a, a};
      default:
        return {a, b};
    }
  }

  std::mt19937 random_{testing::test_seed()};
  std::uniform_real_distribution<double> coordinate_{-150, 150};
};

TEST_F(EdgeGrids, AllThatIsNearASegmentIsInTheCellsNearIt) {
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    std::vector<Segment> segments(100);
    for (Segment& s : segments) s = segment();
    EdgeGrid grid({-100, -100, 100, 100}, 0.5 + 0.5 * round, segments.size());
    for (const LineIndex i : indices<LineIndex>(segments.size()))
      grid.insert(i, segments[i].a, segments[i].b);
    for (const double reach : {0.0, 1.0, 20.0})
      for (int k = 0; k < 50; ++k) {
        const Segment s = segment();
        std::set<LineIndex> seen;
        grid.visit_cells_near(s.a, s.b, reach, [&](std::size_t cell) {
          ASSERT_LT(cell, grid.cell_count());
          grid.visit_cell(cell, [&](LineIndex i) { seen.insert(i); });
        });
        for (const LineIndex i : indices<LineIndex>(segments.size())) {
          const auto [a, b] = segments[i];
          EXPECT_TRUE(grid::segment_distance(s.a, s.b, a, b) > reach || seen.contains(i))
              << i.value();
        }
      }
  }
}

TEST_F(EdgeGrids, FewCellsAreNearASlantedSegment) {
  EdgeGrid grid({0, 0, 100, 100}, 1, 10'000);
  int near = 0, in_box = 0;
  grid.visit_cells_near({5, 5}, {95, 95}, 1, [&](std::size_t) { ++near; });
  grid.visit_cells({4, 4, 96, 96}, [&](std::size_t) { ++in_box; });
  EXPECT_GE(near, 90 * 3);
  EXPECT_LE(near, 95 * 7);
  EXPECT_GE(in_box, 92 * 92);
}

}  // namespace
}  // namespace tetropolis
