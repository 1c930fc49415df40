#include "tetropolis/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/shapes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::random_star;
using testing::test_seed;

Polygon square(double xmin, double ymin, double side) {
  return {{{xmin, ymin}, {xmin + side, ymin}, {xmin + side, ymin + side}, {xmin, ymin + side}}, {}};
}

Ring reversed(Ring ring) { return {ring.rbegin(), ring.rend()}; }

/// Sum of the angles under which the edges are seen, in turns: an independent point-in-polygon
/// test.
double winding_number(const Ring& ring, Point2 p) {
  double turns = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i];
    const Point2 b = ring[(i + 1) % ring.size()];
    turns += std::atan2((a.x - p.x) * (b.y - p.y) - (b.x - p.x) * (a.y - p.y),
                        (a.x - p.x) * (b.x - p.x) + (a.y - p.y) * (b.y - p.y));
  }
  return turns / (2 * M_PI);
}

void expect_strictly_inside(const Polygon& polygon, Point2 p) {
  EXPECT_TRUE(contains(polygon, p)) << p.x << " " << p.y;
  EXPECT_GT(distance_to_boundary(polygon, p), 0) << p.x << " " << p.y;
}

TEST(Polygon, AreaOfSquareWithHoleInAnyOrientation) {
  Polygon polygon = square(1e6, 5e6, 10);
  polygon.holes.push_back(reversed(square(1e6 + 2, 5e6 + 2, 3).outer));
  EXPECT_EQ(signed_area(polygon.outer), 100);
  EXPECT_EQ(signed_area(polygon.holes[0]), -9);
  EXPECT_EQ(area(polygon), 91);
  polygon.outer = reversed(polygon.outer);
  polygon.holes[0] = reversed(polygon.holes[0]);
  EXPECT_EQ(area(polygon), 91);
  EXPECT_EQ(signed_area({{0, 0}, {1, 1}}), 0);
}

TEST(Polygon, BoundsOfVerticesAndOfNothing) {
  EXPECT_EQ(bounds(square(1, 2, 3)), (Bounds2{1, 2, 4, 5}));
  EXPECT_TRUE(bounds(Ring{}).empty());
  EXPECT_TRUE(bounds(Polygon{}).empty());
}

TEST(Polygon, ContainsAgreesWithWindingNumber) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> coordinate(-12, 12);
  int inside = 0;
  for (int round = 0; round < 50; ++round) {
    Polygon polygon{random_star(random, {0, 0}, 5 + round, 5, 10), {}};
    polygon.holes.push_back(reversed(random_star(random, {0.5, -0.3}, 4 + round % 7, 1, 3)));
    for (int k = 0; k < 400; ++k) {
      const Point2 p{coordinate(random), coordinate(random)};
      if (distance_to_boundary(polygon, p) < 1e-9) continue;
      const double turns = winding_number(polygon.outer, p) + winding_number(polygon.holes[0], p);
      ASSERT_EQ(contains(polygon, p), turns > 0.5) << "seed " << test_seed() << " round " << round;
      inside += contains(polygon, p) ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 4000);
}

TEST(Polygon, PointsOnSharedEdgesAreInExactlyOneNeighbour) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  std::uniform_real_distribution<double> share(0, 1);
  constexpr int kCells = 8;
  // A perturbed grid of quadrilaterals that tile a square.
  std::vector<std::vector<Point2>> nodes(kCells + 1, std::vector<Point2>(kCells + 1));
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) nodes[j][i] = {i + shift(random), j + shift(random)};
  std::vector<Polygon> quads;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      Polygon quad{{nodes[j][i], nodes[j][i + 1], nodes[j + 1][i + 1], nodes[j + 1][i]}, {}};
      if ((i + j) % 3 == 0) quad.outer = reversed(quad.outer);
      quads.push_back(quad);
    }
  const auto owners = [&](Point2 p) {
    int count = 0;
    for (const Polygon& quad : quads) count += contains(quad, p) ? 1 : 0;
    return count;
  };
  for (int j = 1; j < kCells; ++j)
    for (int i = 1; i < kCells; ++i) {
      EXPECT_EQ(owners(nodes[j][i]), 1) << "seed " << test_seed();
      for (const Point2 to : {nodes[j][i + 1], nodes[j + 1][i]}) {
        for (int k = 0; k < 20; ++k) {
          const double t = share(random);
          const Point2 from = nodes[j][i];
          EXPECT_EQ(owners({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)}), 1)
              << "seed " << test_seed();
        }
      }
    }
}

TEST(Polygon, DistanceToSegment) {
  EXPECT_DOUBLE_EQ(distance_to_segment({0, 3}, {-1, 0}, {1, 0}), 3);
  EXPECT_DOUBLE_EQ(distance_to_segment({4, 4}, {-1, 0}, {1, 0}), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment({4, 4}, {1, 0}, {1, 0}), 5);
  EXPECT_EQ(distance_to_segment({0.5, 0}, {-1, 0}, {1, 0}), 0);
}

TEST(Polygon, DistanceToBoundaryAgreesWithDenseSampling) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> coordinate(-12, 12);
  Polygon polygon{random_star(random, {0, 0}, 9, 5, 10), {random_star(random, {0, 0}, 5, 1, 3)}};
  for (int k = 0; k < 100; ++k) {
    const Point2 p{coordinate(random), coordinate(random)};
    double nearest = std::numeric_limits<double>::infinity();
    for_each_edge(polygon, [&](Point2 a, Point2 b) {
      for (int s = 0; s <= 2000; ++s)
        nearest = std::min(nearest, std::hypot(a.x + (b.x - a.x) * s / 2000 - p.x,
                                               a.y + (b.y - a.y) * s / 2000 - p.y));
    });
    const double distance = distance_to_boundary(polygon, p);
    EXPECT_LE(distance, nearest + 1e-12) << "seed " << test_seed();
    EXPECT_NEAR(distance, nearest, 0.01) << "seed " << test_seed();
  }
  EXPECT_EQ(distance_to_boundary(Polygon{}, {0, 0}), std::numeric_limits<double>::infinity());
}

TEST(InteriorPoint, OfSimpleShapes) {
  EXPECT_EQ(interior_point(square(0, 0, 1)), (Point2{0.5, 0.5}));
  // A U: the centre of its box is outside, the line at mid-height meets two arms of 1 and 2 m.
  const Polygon u{{{0, 0}, {9, 0}, {9, 8}, {7, 8}, {7, 1}, {1, 1}, {1, 8}, {0, 8}}, {}};
  EXPECT_EQ(interior_point(u), (Point2{8, 4.5}));
  // A courtyard: the wider of the two sides.
  Polygon ring = square(0, 0, 10);
  ring.holes.push_back(reversed({{1, 1}, {7, 1}, {7, 9}, {1, 9}}));
  EXPECT_EQ(interior_point(ring), (Point2{8.5, 5}));
}

TEST(InteriorPoint, OfRandomPolygonsWithHoles) {
  std::mt19937 random(test_seed());
  for (int round = 0; round < 500; ++round) {
    SCOPED_TRACE("seed " + std::to_string(test_seed()) + " round " + std::to_string(round));
    Polygon polygon{random_star(random, {1e5, 2e5}, 3 + round % 40, 4.5, 10), {}};
    if (polygon.outer.size() > 12)
      polygon.holes.push_back(random_star(random, {1e5 + 0.1, 2e5 - 0.2}, 3 + round % 5, 1, 3));
    if (round % 2 == 0) polygon.outer = reversed(polygon.outer);
    expect_strictly_inside(polygon, interior_point(polygon));
  }
}

TEST(InteriorPoint, OfCombsAndSlivers) {
  Ring comb;
  for (int k = 0; k < 50; ++k) {
    comb.push_back({static_cast<double>(k), 0});
    comb.push_back({k + 0.5, 100.0 + k % 3});
  }
  comb.push_back({50, 0});
  comb.push_back({50, -0.001});
  comb.push_back({0, -0.001});
  expect_strictly_inside({comb, {}}, interior_point({comb, {}}));

  const Polygon thin{{{0, 0}, {1000, 1000}, {1000, 1000.0001}}, {}};
  expect_strictly_inside(thin, interior_point(thin));
  // Vertices almost level with each other: the slab at the centre is one unit in the last place
  // high, so a line within it runs through a vertex.
  const double y = 1.0;
  const double above = std::nextafter(y, 2);
  const Polygon level{{{0, 0}, {4, y}, {0, 2}, {-4, above}}, {}};
  expect_strictly_inside(level, interior_point(level));
  // The two triangles of a bow tie that meets in one point, with that point at mid-height.
  const Polygon hourglass{{{0, 0}, {4, 0}, {2, 1}, {4, 2}, {0, 2}, {2, above}}, {}};
  expect_strictly_inside(hourglass, interior_point(hourglass));
}

TEST(InteriorPoint, WithoutInteriorIsTheMiddleOfTheBox) {
  EXPECT_EQ(interior_point({{{0, 0}, {4, 0}}, {}}), (Point2{2, 0}));
  EXPECT_EQ(interior_point({{{0, 0}, {4, 2}}, {}}), (Point2{2, 1}));
  EXPECT_EQ(interior_point({{{3, 3}}, {}}), (Point2{3, 3}));
}

}  // namespace
}  // namespace tetropolis
