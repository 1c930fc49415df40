// Footprints by place, against looking at all of them.
#include "check/footprint_grid.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "check/check_regions.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::rectangle;

CityModel buildings_on(const std::vector<Polygon>& footprints) {
  CityModel city;
  for (const Polygon& footprint : footprints) {
    city.buildings.emplace_back();
    city.buildings.back().footprint = footprint;
  }
  return city;
}

TEST(FootprintGrid, FindsTheBuildingOfAnyPointWhateverTheDomain) {
  std::mt19937 random(testing::test_seed());
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Polygon> footprints;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      footprints.push_back(rectangle(100 * i, 30 * j, 100 * i + uniform(1, 99), 30 * j + 25));
  footprints.push_back({});                                   // of no vertex
  footprints.push_back(rectangle(-1e6, 1e6, -1e6 + 5, 2e6));  // far away
  CityModel city = buildings_on(footprints);
  const double inf = std::numeric_limits<double>::infinity();
  for (const Bounds2& domain :
       {Bounds2::nothing(), Bounds2{0, 0, 1e9, 1e9}, Bounds2{0, 0, 1e5, 1e5}, Bounds2{}}) {
    city.domain = domain;
    const FootprintGrid grid(city);
    for (int i = 0; i < 2000; ++i) {
      const double x = uniform(-50, 2050), y = uniform(-50, 650);
      BuildingIndex expected = kNoBuilding;
      for (std::size_t b = 0; b < footprints.size(); ++b)
        if (contains(footprints[b], {x, y})) expected = BuildingIndex(b);
      EXPECT_EQ(grid.at(x, y), expected) << x << " " << y << ", seed " << testing::test_seed();
    }
    EXPECT_EQ(grid.at(-1e6 + 1, 1.5e6), 401);
    for (const double odd : {std::nan(""), inf, -inf, 1e300})
      EXPECT_EQ(grid.at(odd, odd), kNoBuilding);
  }
}

TEST(FootprintGrid, EmptyCitiesAndEmptyRingsHaveNoBuildings) {
  EXPECT_EQ(FootprintGrid(CityModel{}).at(0, 0), kNoBuilding);
  const CityModel city = buildings_on({Polygon{}, Polygon{}});
  EXPECT_EQ(FootprintGrid(city).at(0, 0), kNoBuilding);
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.cells = {{0, 1, 2, 3}};
  mesh.region = {kNoBuilding.value()};
  EXPECT_TRUE(check_regions(mesh, {0, 0, 0}, city).empty());
}

TEST(FootprintGrid, OutlinesOfManyVerticesAreLookedAtInParts) {
  std::mt19937 random(testing::test_seed());
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Polygon star;  // winds around, with a hole that does, too
  for (const double radius : {100.0, 40.0}) {
    Ring ring;
    for (int i = 0; i < 4000; ++i) {
      const double r = radius * uniform(0.6, 1), angle = i * 6.28318 / 4000;
      ring.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    radius > 50 ? star.outer = ring : star.holes.emplace_back(ring);
  }
  Polygon comb;  // teeth as tall as the comb
  for (int i = 0; i < 4000; ++i)
    comb.outer.push_back({200 + 0.02 * i, i % 4 < 2 ? uniform(-100, -90) : uniform(90, 100)});
  comb.outer.insert(comb.outer.end(), {{280, -200}, {200, -200}});
  const CityModel city = buildings_on({star, comb});
  const FootprintGrid grid(city);
  EXPECT_LE(grid.edge_entries(), std::size_t{8} * 12002);
  for (int i = 0; i < 5000; ++i) {
    const double x = uniform(-110, 290), y = uniform(-210, 110);
    EXPECT_EQ(grid.at(x, y), contains(star, {x, y})   ? 0
                             : contains(comb, {x, y}) ? 1
                                                      : -1)
        << x << " " << y << ", seed " << testing::test_seed();
  }
}

TEST(FootprintGrid, MemoryGrowsWithTheNumberOfBuildingsOnly) {
  // Each covers nearly all of the city.
  std::vector<Polygon> nested;
  for (int i = 0; i < 2000; ++i) nested.push_back(rectangle(i, i, 10000 - i, 10000 - i));
  const CityModel city = buildings_on(nested);
  const FootprintGrid grid(city);
  EXPECT_EQ(grid.at(5, 5000), 0);
  EXPECT_LE(grid.squares(), 3 * nested.size() + 4);
  EXPECT_LE(grid.entries(), 16 * nested.size());
  const CityModel far =
      buildings_on({rectangle(0, 0, 10, 10), rectangle(1e9, 1e9, 1e9 + 10, 1e9 + 10)});
  EXPECT_LE(FootprintGrid(far).squares(), 10U);
  EXPECT_EQ(FootprintGrid(far).at(1e9 + 5, 1e9 + 5), 1);
}

}  // namespace
}  // namespace tetropolis
