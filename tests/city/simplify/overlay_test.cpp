#include "city/simplify/overlay.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "geometry/geos.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

double total_area(const std::vector<Polygon>& polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area(polygon);
  return sum;
}

/// Of those wider than what rounding may open and close.
std::size_t total_holes(const std::vector<Polygon>& polygons) {
  std::size_t sum = 0;
  for (const Polygon& polygon : polygons) {
    for (const Ring& hole : polygon.holes) {
      double length = 0;
      for_each_edge(Polygon{hole, {}},
                    [&](Point2 a, Point2 b) { length += std::hypot(a.x - b.x, a.y - b.y); });
      if (std::abs(signed_area(hole)) > 5 * length) ++sum;
    }
  }
  return sum;
}

Ring square(double x, double y, double side) {
  return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
}

Ring reversed(Ring ring) { return {ring.rbegin(), ring.rend()}; }

/// `got` covers what GEOS, given everything at once, says: up to a few steps along the boundary.
void expect_same_area(const std::vector<Polygon>& got, const geos::Result& expected) {
  ASSERT_TRUE(expected);
  EXPECT_TRUE(geos::is_valid(got));
  EXPECT_EQ(got.size(), expected->size());
  EXPECT_EQ(total_holes(got), total_holes(*expected));
  double length = 0;
  for (const Polygon& polygon : *expected)
    for_each_edge(polygon, [&](Point2 a, Point2 b) { length += std::hypot(a.x - b.x, a.y - b.y); });
  for (const auto& difference :
       {geos::subtract(got, *expected, 0), geos::subtract(*expected, got, 0)}) {
    ASSERT_TRUE(difference);
    EXPECT_LT(total_area(*difference), 2 * length);
  }
}

/// Turned rectangles of 10 to 200 m in steps of 0.1 mm, most of them overlapping.
std::vector<Polygon> turned_rectangles(int count, double place, std::mt19937& random) {
  std::uniform_real_distribution<double> at(0, place), side(1e5, 2e6), turn(0, std::numbers::pi);
  std::vector<Polygon> result;
  for (int i = 0; i < count; ++i) {
    const double x = at(random), y = at(random), w = side(random) / 2, h = side(random) / 2;
    const double c = std::cos(turn(random)), s = std::sin(turn(random));
    const double n = std::hypot(c, s);
    Ring ring;
    for (const Point2 p : {Point2{-w, -h}, {w, -h}, {w, h}, {-w, h}})
      ring.push_back(
          {std::round(x + (p.x * c - p.y * s) / n), std::round(y + (p.x * s + p.y * c) / n)});
    result.push_back({ring, {}});
  }
  return result;
}

TEST(Overlay, UnionsOfManyAreThoseOfAllAtOnce) {
  std::mt19937 random(testing::test_seed());
  for (const double place : {4e7, 2e7, 1e7}) {
    SCOPED_TRACE(place);
    const std::vector<Polygon> polygons = turned_rectangles(1500, place, random);
    expect_same_area(unite_on_grid(polygons), geos::unite(polygons, 1.0));
  }
}

/// Rings in the courtyards of rings, eight deep, and everything apart: nothing is to change. The
/// halves of the plane meet within them.
/// A sliver of two steps beside two blocks across each other: rounded, it may cross itself, and
/// what is then noded anew is one polygon. (A tester's.)
TEST(Overlay, UnionsWithSliversAreOnTheGrid) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
  for (int round = 0; round < 400; ++round) {
    const double turn = between(0, 2 * std::numbers::pi), bend = between(-0.3, 0.3);
    const Point2 wing{between(-1e5, 1e5), between(-1.4e5, 1.4e5)};
    const auto turned = [](Point2 p, double angle, Point2 at) {
      return Point2{at.x + std::cos(angle) * p.x - std::sin(angle) * p.y,
                    at.y + std::sin(angle) * p.x + std::cos(angle) * p.y};
    };
    const auto placed = [&](Point2 p) { return grid::rounded(turned(p, turn, {8e5, 2.4e6})); };
    Polygon block, across, sliver;
    for (const Point2 p : {Point2{-2e5, -1.2e5}, {2e5, -1.2e5}, {2e5, 1.2e5}, {-2e5, 1.2e5}})
      block.outer.push_back(placed(p));
    for (const Point2 p : {Point2{-1.5e5, -6e4}, {1.5e5, -6e4}, {1.5e5, 6e4}, {-1.5e5, 6e4}})
      across.outer.push_back(placed(turned(p, bend, wing)));
    const Point2 foot{between(-2e5, 2e5), between(-1.2e5, 1.2e5)};
    const double direction = between(0, 2 * std::numbers::pi);
    for (const Point2 p : {Point2{0, 0}, {1e5, 0}, {6e4, 2}})
      sliver.outer.push_back(placed(turned(p, direction, foot)));
    if (signed_area(sliver.outer) <= 0) continue;  // flat on the grid
    const std::vector<Polygon> united = unite_on_grid(std::vector{block, across, sliver});
    ASSERT_TRUE(geos::is_valid(united));
    for (const Polygon& polygon : united)
      for_each_edge(polygon,
                    [&](Point2 p, Point2) { ASSERT_EQ(p, grid::rounded(p)) << "round " << round; });
  }
}

TEST(Overlay, WhatStandsInCourtyardsStays) {
  std::vector<Polygon> polygons;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 8; ++k) {
        const double x = i * 1e6 + k * 5e4, y = j * 1e6 + k * 5e4, side = 9e5 - k * 1e5;
        polygons.push_back({square(x, y, side), {}});
        if (k < 7) polygons.back().holes.push_back(reversed(square(x + 2e4, y + 2e4, side - 4e4)));
      }
  // One building across many of them, so that there is something to join.
  polygons.push_back({square(2.5e6, 2.95e6, 5e6), {}});
  const std::vector<Polygon> united = unite_on_grid(polygons);
  expect_same_area(united, geos::unite(polygons, 1.0));
  EXPECT_GT(united.size(), 100U);
}

TEST(Overlay, AHouseInACourtyardFarFromTheFillStays) {
  const std::vector<Polygon> houses{{square(0, 0, 1e6), {reversed(square(2e5, 2e5, 6e5))}},
                                    {square(4e5, 4e5, 2e5), {}}};
  const std::vector<Polygon> fill{{square(9.5e5, 4e5, 1e5), {}}};
  const std::vector<Polygon> got = add_on_grid(houses, fill);
  expect_same_area(got, geos::join(houses, fill, 1.0));
  EXPECT_EQ(got.size(), 2U);
}

/// A plate of 20 x 20 holes.
Polygon plate() {
  Polygon plate{square(0, 0, 4.1e6), {}};
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      plate.holes.push_back(reversed(square(1e5 + i * 2e5, 1e5 + j * 2e5, 1e5)));
  return plate;
}

TEST(Overlay, FillsInAndAroundAPlateWithManyHoles) {
  std::vector<Polygon> fills;
  const auto add = [&](double x, double y, double w, double h) {
    fills.push_back({{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, {}});
  };
  add(1e5, 1e5, 1e5, 1e5);          // exactly a hole
  add(2.9e5, 2.9e5, 1.2e5, 1.2e5);  // more than one
  add(5e5, 5.4e5, 1e5, 1e4);        // across one: two are left
  add(7.2e5, 6.9e5, 1e4, 5e4);      // into one
  add(9.5e5, 9.5e5, 6e5, 1e4);      // across several and the plate between them
  add(4.05e6, 1e6, 2e5, 1e5);       // over the rim
  add(4.1e6, 2e6, 3e5, 1e5);        // a handle outside, which makes a hole
  add(4.3e6, 2e6, 1e5, 5e5);
  add(4.1e6, 2.4e6, 3e5, 1e5);
  add(5e6, 5e6, 1e5, 1e5);        // apart
  add(1.72e6, 1.02e6, 1e3, 1e3);  // wholly within the plate
  const std::vector<Polygon> whole{plate()};
  const std::vector<Polygon> united = *geos::unite(fills, 1.0);
  expect_same_area(add_on_grid(whole, fills), geos::join(whole, united, 1.0));
  // Free in a hole: it is a polygon of its own.
  add(1.32e6, 1.32e6, 1e4, 1e4);
  const std::vector<Polygon> more = *geos::unite(fills, 1.0);
  const std::vector<Polygon> got = add_on_grid(whole, fills);
  expect_same_area(got, geos::join(whole, more, 1.0));
  EXPECT_EQ(got.size(), 3U);
}

TEST(Overlay, RandomFillsOnAPlate) {
  std::mt19937 random(testing::test_seed());
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    std::vector<Polygon> fills;
    for (Polygon& fill : turned_rectangles(60, 4.4e6, random)) {
      for (Point2& p : fill.outer) {
        const Point2 centre = fill.outer[0];
        p = {std::round(centre.x + (p.x - centre.x) / 20),
             std::round(centre.y + (p.y - centre.y) / 20)};
      }
      fills.push_back(fill);
    }
    const std::vector<Polygon> whole{plate()};
    const geos::Result united = geos::unite(fills, 1.0);
    ASSERT_TRUE(united);
    expect_same_area(add_on_grid(whole, fills), geos::join(whole, *united, 1.0));
  }
}

/// Long slanted holes and fills, whose boxes nearly all meet, wherever they are.
TEST(Overlay, FillsOnSlantedSlits) {
  std::mt19937 random(testing::test_seed());
  const auto at = [](double along, double across) {  // turned by 30 degrees
    const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
    return Point2{std::round(along * c - across * s), std::round(along * s + across * c)};
  };
  const auto strip = [&](double x, double y, double length, double width) {
    return Ring{at(x, y), at(x + length, y), at(x + length, y + width), at(x, y + width)};
  };
  Polygon slab{strip(0, 0, 2e6, 4e5), {}};
  constexpr double kPitch = 3000;
  for (int k = 1; k < 130; ++k)
    slab.holes.push_back(reversed(strip(1e5, k * kPitch, 1.8e6, kPitch / 2)));
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    std::vector<Polygon> fills;
    for (int k = 0; k < 40; ++k)  // within a slit, across one, over it, within the slab
      fills.push_back(
          {strip(static_cast<double>(random() % 2'000'000), static_cast<double>(random() % 400'000),
                 static_cast<double>(1000 + random() % 1'900'000),
                 static_cast<double>(100 + random() % 4000)),
           {}});
    fills.push_back({strip(9e4, kPitch * (round + 3) - 1000, 1.82e6, kPitch), {}});
    const std::vector<Polygon> whole{slab};
    const geos::Result united = geos::unite(fills, 1.0);
    ASSERT_TRUE(united);
    expect_same_area(add_on_grid(whole, fills), geos::join(whole, *united, 1.0));
  }
}

/// Holes go back to the part that has them.
TEST(Overlay, CutsThatPartAPlateWithHoles) {
  std::mt19937 random(testing::test_seed());
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    std::vector<Polygon> cuts;
    const auto at = [&] { return static_cast<double>(random() % 4'100'000); };
    for (int k = 0; k < 1 + round / 4; ++k) {
      const double x = at(), y = at(), w = 1000 + at() / 100;
      cuts.push_back({{{x, -1e5}, {x + w, -1e5}, {y + w, 4.2e6}, {y, 4.2e6}}, {}});
    }
    cuts.push_back({square(at(), at(), 5e5), {}});
    const std::vector<Polygon> whole{plate()};
    const std::vector<Polygon> got = subtract_on_grid(whole, cuts);
    EXPECT_GT(got.size(), 1U);
    expect_same_area(got, geos::subtract(whole, cuts, 1.0));
  }
}

/// Cutting a slanted wall bends it over its whole length, by less than a step, which is more than
/// what lies between it and the corner of a hole or of a neighbour.
TEST(Overlay, WallsThatBendKeepClearOfWhatIsFarFromTheCut) {
  std::mt19937 random(testing::test_seed());
  int close = 0;
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    const double length = 8e4 + static_cast<double>(random() % 40000);
    const double slope = -8e3 - static_cast<double>(random() % 5000);
    // The lowest point of the grid above the wall, of those columns the one nearest to it.
    Point2 corner;
    double gap = 1;
    for (double x = 0.7 * length; x < 0.85 * length; ++x) {
      const double wall = x * slope / length, y = std::floor(wall) + 1;
      if (y - wall < gap) {
        gap = y - wall;
        corner = {std::floor(x), std::floor(std::floor(x) * slope / length) + 1};
      }
    }
    const Ring hole{corner, {corner.x - 2000, corner.y + 2e4}, {corner.x + 2000, corner.y + 2e4}};
    const std::vector<Polygon> with_hole{
        {{{0, 0}, {length, slope}, {length, 8e4}, {0, 8e4}}, {hole}}};
    const std::vector<Polygon> with_house{
        {{{0, 0}, {0, -8e4}, {length, -8e4}, {length, slope}}, {}},
        {{hole.rbegin(), hole.rend()}, {}}};
    if (!geos::is_valid(with_hole)) continue;
    ++close;
    const double x = static_cast<double>(20000 + random() % 20000), y = x * slope / length;
    const std::vector<Polygon> cut{
        {{{x, std::floor(y) - 3000}, {x + 2200, std::floor(y) - 3300}, {x + 2100, 3000}, {x, 3000}},
         {}}};
    for (const auto& whole : {with_hole, with_house}) {
      EXPECT_TRUE(geos::is_valid(subtract_on_grid(whole, cut)));
      EXPECT_TRUE(geos::is_valid(add_on_grid(whole, cut)));
    }
  }
  EXPECT_GT(close, 200);
}

TEST(Overlay, TheSameForAnyNumberOfThreads) {
  std::mt19937 random(testing::test_seed());
  const std::vector<Polygon> polygons = turned_rectangles(2000, 2e7, random);
  std::vector<std::vector<Polygon>> results;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    results.push_back(unite_on_grid(polygons));
  }
  for (const auto& result : results) {
    ASSERT_EQ(result.size(), results[0].size());
    for (std::size_t i = 0; i < result.size(); ++i) {
      EXPECT_EQ(result[i].outer, results[0][i].outer);
      EXPECT_EQ(result[i].holes, results[0][i].holes);
    }
  }
}

}  // namespace
}  // namespace tetropolis
