#include "volume/column/ground_heights.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/indices.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

TEST(GroundHeights, FollowTheTerrainExceptUnderLowRoofs) {
  // A slope of 45 degrees: the first building's roof is below the ground at its uphill wall.
  auto city = testing::small_city([](double x, double) { return x; });
  city.roofs = {30, 1000, 1000, 1000, 1000};
  const GroundMesh mesh = mesh_ground(city.footprints, city.domain, {8, 25});
  const auto owner = lowest_roofs(mesh, city.roofs);
  std::vector<double> ground = terrain_under(mesh, city.dtm);
  const std::vector<double> least(ground.size(), 1.5), wall(ground.size(), 4.0);
  lower_at_walls(mesh, owner, city.roofs, least, wall, ground);
  std::int64_t lowered = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Point2 p = mesh.vertices[v];
    const double terrain = p.x;  // bilinear interpolation of a plane is the plane
    if (owner[v] == 0 && terrain > 28.5) {
      EXPECT_EQ(ground[v], 26);  // terrain above 28.5 m goes down to 4 m below the roof
      ++lowered;
    } else {
      EXPECT_NEAR(ground[v], terrain, 1e-9);
    }
  }
  EXPECT_GT(lowered, 0);
}

RoofPlane level(double elevation) { return {{}, elevation, 0, 0}; }

TEST(GroundHeights, LowWallsAskForShortEdges) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const Raster flat = testing::raster_of({0, 0, 50, 50}, [](double, double) { return 7.0; });
  EXPECT_DOUBLE_EQ(longest_wall_edge(flat, level(10), {5, 5}, {30, 5}, 0.5), 12);
  EXPECT_DOUBLE_EQ(longest_wall_edge(flat, level(7.6), {5, 5}, {30, 5}, 0.5),
                   4);  // a metre at least
  EXPECT_EQ(longest_wall_edge(flat, level(7.4), {5, 5}, {30, 5}, 0.5), inf);
  // A ridge across the wall between its ends is seen.
  const Raster ridge = testing::raster_of(
      {0, 0, 50, 50}, [](double x, double) { return std::abs(x - 20) < 1.5 ? 8.0 : 0.0; });
  EXPECT_DOUBLE_EQ(longest_wall_edge(ridge, level(10), {5, 5}, {35, 5}, 0.5), 8);
  EXPECT_DOUBLE_EQ(longest_wall_edge(ridge, level(10), {5, 5}, {12, 5}, 0.5), 40);
  EXPECT_EQ(longest_wall_edge(ridge, level(8.2), {5, 5}, {35, 5}, 0.5), inf);  // steep, and lowered
  // Where the ground will be lowered on a gentle slope, only the rest of the wall counts.
  const Raster slope = testing::raster_of({0, 0, 50, 50}, [](double x, double) { return 0.1 * x; });
  EXPECT_DOUBLE_EQ(longest_wall_edge(slope, level(2), {0, 5}, {10, 5}, 0.5), 4);
  EXPECT_DOUBLE_EQ(longest_wall_edge(slope, level(2), {0, 5}, {20, 5}, 0.5), 4);
  EXPECT_DOUBLE_EQ(longest_wall_edge(slope, level(2), {0, 5}, {40, 5}, 0.5), 3 * 2);
  EXPECT_EQ(longest_wall_edge(slope, level(2), {18, 5}, {40, 5}, 0.5), inf);
}

TEST(GroundHeights, VerticesKnowTheirBuilding) {
  const auto city = testing::small_city(testing::hills);
  const GroundMesh mesh = mesh_ground(city.footprints, city.domain, {8, 25});
  const auto owner = lowest_roofs(mesh, city.roofs);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Point2 p = mesh.vertices[v];
    const bool in_first = p.x >= 20 && p.x <= 38 && p.y >= 15 && p.y <= 27;
    EXPECT_EQ(owner[v] == 0, in_first);
    const bool in_yard = p.x > 80 && p.x < 95 && p.y > 30 && p.y < 50;
    if (in_yard) {
      EXPECT_EQ(owner[v], kNoRegion);
    }
  }
}

TEST(GroundHeights, OfRoofsThatTouchTheLowestCounts) {
  GroundMesh mesh;
  mesh.vertices = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  mesh.triangles = testing::triangles_of({{0, 1, 2}, {1, 3, 2}});
  mesh.region = testing::indices_of<RegionIndex>({0, 1});
  mesh.regions = testing::regions_of_buildings(2);
  EXPECT_EQ(lowest_roofs(mesh, std::vector{7.0, 5.0}),
            (testing::indices_of<RegionIndex>({0, 1, 1, 1})));
  EXPECT_EQ(lowest_roofs(mesh, std::vector{5.0, 7.0}),
            (testing::indices_of<RegionIndex>({0, 0, 0, 1})));
}

}  // namespace
}  // namespace tetropolis
