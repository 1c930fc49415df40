// Which footprints contain a position, against the definition, and what it takes to tell.
#include "city/footprint_index.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "footprint_checks.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::circle;
using testing::test_seed;
using testing::turned;

/// Teeth of 40 m x 1 cm, 1 cm apart, that point north.
Polygon comb(int teeth) {
  Polygon polygon{{{0, -5}, {0.02 * teeth, -5}}, {}};
  for (int i = teeth - 1; i >= 0; --i)
    polygon.outer.insert(
        polygon.outer.end(),
        {{0.02 * i + 0.02, 40}, {0.02 * i + 0.01, 40}, {0.02 * i + 0.01, 0}, {0.02 * i, 0}});
  return polygon;
}

/// Random positions in the box and a little around it.
std::vector<Point2> positions(const Polygon& footprint, int n, std::mt19937& random) {
  const Bounds2 box = bounds(footprint).grown(5);
  std::uniform_real_distribution<double> x(box.xmin, box.xmax), y(box.ymin, box.ymax);
  std::vector<Point2> result;
  for (int k = 0; k < n; ++k) result.push_back({x(random), y(random)});
  return result;
}

TEST(FootprintIndex, LargeOutlinesAgreeWithTheDefinition) {
  SCOPED_TRACE(test_seed());
  std::mt19937 random(test_seed());
  const double quarter = std::numbers::pi / 2;
  for (const Polygon& footprint :
       {comb(5000), turned(comb(5000), quarter), turned(comb(5000), 0.3), circle({3, 4}, 50, 20000),
        circle({3, 4}, 500, 20000), circle({0, 0}, 10, 7)}) {
    const Polygon* const one[] = {&footprint};
    std::size_t edges = 0;
    for_each_edge(footprint, [&](Point2, Point2) { ++edges; });
    for (const double margin : {0.0, 1.0, 20.0}) {
      const FootprintIndex index(one, margin);
      EXPECT_LE(index.entries(), FootprintIndex::kEntriesPerEdge * edges);
      for (const Point2 p : positions(footprint, 300, random)) {
        int found = 0;  // 1 near, 2 inside
        index.at(p, [&](BuildingIndex, bool inside) { found = inside ? 2 : 1; });
        const double distance = distance_to_boundary(footprint, p);
        ASSERT_EQ(found, contains(footprint, p) ? 2 : (distance <= margin ? 1 : 0))
            << p.x << " " << p.y << " margin " << margin;
        if (distance <= margin) {
          ASSERT_DOUBLE_EQ(std::sqrt(index.squared_distance(BuildingIndex(0), p)), distance);
        }
      }
    }
  }
}

/// As long as edges do not all run from south to north, the number looked at does not grow with
/// that of the outline.
TEST(FootprintIndex, TakesAFewEdgesOfLargeOutlines) {
  for (const int vertices : {2000, 20000, 200000}) {
    const Polygon footprint = circle({0, 0}, 500, vertices);
    const Polygon* const one[] = {&footprint};
    const FootprintIndex index(one, 1);
    double sum = 0;
    for (int k = 0; k < 1000; ++k)
      sum += static_cast<double>(index.edges_at(BuildingIndex(0), -499.5 + 0.999 * k));
    EXPECT_LE(sum / 1000, 24) << vertices;
  }
}

}  // namespace
}  // namespace tetropolis
