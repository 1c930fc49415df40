// Costs of lines that move over points, against all points and the definition.
#include "city/roofs/region_points.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "geometry/predicates.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

/// Two planes over a square, and points around these.
struct TwoRoofs {
  std::vector<Point3> points;
  std::vector<double> weights;
  std::vector<RoofRegion> region_of;
  std::vector<RegionRoof> roofs{{{{2, 3}, 5, 0.4, -0.1}, 0, Lod::k2_2},
                                {{{6, 1}, 7, -0.3, 0.2}, 0, Lod::k2_2}};
  std::mt19937 random{test_seed()};
  static constexpr double kSide = 8;

  TwoRoofs() {
    for (int k = 0; k < 2000; ++k) {
      const Point2 p = place();
      const RoofRegion region = p.x < p.y ? 0 : 1;
      points.push_back({p.x, p.y, roofs[static_cast<std::size_t>(region)].plane(p) + number() - 4});
      weights.push_back(0.1 + number());
      region_of.push_back(k % 50 == 0 ? -1 : region);
    }
  }
  double number() { return std::uniform_real_distribution<double>(0, kSide)(random); }
  Point2 place() { return {number(), number()}; }
  RegionPoints region_points() const {
    return {points, weights, region_of, roofs, {0, 0, kSide, kSide}, 50, 3};
  }

  double cost_by_definition(const Ring& triangle, std::size_t from, std::size_t to) const {
    const auto huber = [](double d) { return std::abs(d) < 1 ? d * d : 2 * std::abs(d) - 1; };
    double sum = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Point2 q{points[p][0], points[p][1]};
      if (region_of[p] < 0 || !contains({triangle, {}}, q)) continue;
      sum += weights[p] * (huber(points[p][2] - roofs[to].plane(q)) -
                           huber(points[p][2] - roofs[from].plane(q)));
    }
    const auto& [a, b, c] = std::array{triangle[0], triangle[1], triangle[2]};
    const Point2 middle{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
    const double size = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    return sum + 0.1 * size * huber(roofs[to].plane(middle) - roofs[from].plane(middle));
  }
};

TEST(RegionPoints, CostsOfTrianglesAreThoseOfTheirPoints) {
  TwoRoofs two;
  const RegionPoints points = two.region_points();
  for (int k = 0; k < 300; ++k) {
    Point2 a = two.place(), b = two.place(), c = two.place();
    if (k % 3 == 0) c = {a.x + (c.x - a.x) * 0.02, b.y};   // thin, with a level edge
    if (k % 7 == 0) b = {b.x + TwoRoofs::kSide, b.y - 2};  // beyond the points
    EXPECT_NEAR(points.cost_of_triangle(a, b, c, 0, 1), two.cost_by_definition({a, b, c}, 0, 1),
                1e-8);
  }
}

TEST(RegionPoints, CostsOfMovesAreThoseOfTriangles) {
  TwoRoofs two;
  const RegionPoints points = two.region_points();
  for (int k = 0; k < 100; ++k) {
    const Point2 from = two.place(), to = two.place();
    std::vector<Point2> places;
    for (int n = 0; n < 20; ++n)
      places.push_back({from.x + 0.1 * (two.number() - 4), from.y + 0.2 * (two.number() - 4)});
    std::vector<double> sums(places.size(), 0);
    points.add_costs_of_moves(from, to, places, 1, 0, sums);
    for (std::size_t n = 0; n < places.size(); ++n) {
      const bool is_left = orient2d(from, to, places[n]) > 0;
      EXPECT_EQ(sums[n], is_left ? points.cost_of_triangle(from, to, places[n], 1, 0)
                                 : points.cost_of_triangle(from, to, places[n], 0, 1));
    }
  }
}

TEST(RegionPoints, FitsWhatHasChangedAsIfAllWereNew) {
  TwoRoofs two;
  two.roofs.push_back(two.roofs[0]);
  for (std::size_t p = 0; p < two.points.size(); ++p)
    if (two.region_of[p] >= 0 && two.points[p][1] > 5) two.region_of[p] = 2;
  RegionPoints points = two.region_points();
  for (int k = 0; k < 20; ++k) points.fit();
  points.merge(0, 1);
  TwoRoofs anew = two;
  anew.roofs = points.roofs();
  anew.region_of.assign(anew.points.size(), -1);
  for (RoofRegion r = 0; r < 3; ++r)
    for (const std::uint32_t p : points.points_of(r)) anew.region_of[p] = r;
  RegionPoints expected = anew.region_points();
  bool any = false;
  for (int k = 0; k < 3; ++k) {
    const std::vector<RegionRoof> before = points.roofs();
    points.fit();
    expected.fit();
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_EQ(points.roofs()[r].plane, expected.roofs()[r].plane);
      any = any || points.roofs()[r].plane != before[r].plane;
    }
  }
  EXPECT_TRUE(any);
}

}  // namespace
}  // namespace tetropolis
