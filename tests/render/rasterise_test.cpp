#include "render/rasterise.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "random_scene.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

/// Twelve triangles around the cube from -1 to 1.
testing::RandomScene cube() {
  testing::RandomScene scene;
  for (const double z : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double x : {-1.0, 1.0}) scene.points.emplace_back(x, y, z);
  for (const auto& [a, b, c, d] : std::vector<std::array<std::int32_t, 4>>{
           {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
    scene.triangles.push_back({a, b, c});
    scene.triangles.push_back({a, c, d});
  }
  return scene;
}

/// Area of the convex hull of points in the picture (Andrew's monotone chain).
double hull_area(std::vector<std::pair<double, double>> points) {
  std::sort(points.begin(), points.end());
  std::vector<std::pair<double, double>> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const auto& p : points) {
      const auto turns = [&] {
        const auto &a = hull[hull.size() - 2], &b = hull.back();
        return (b.first - a.first) * (p.second - a.second) -
               (b.second - a.second) * (p.first - a.first);
      };
      while (hull.size() >= begin + 2 && turns() <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  double twice = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const auto &a = hull[i], &b = hull[(i + 1) % hull.size()];
    twice += a.first * b.second - a.second * b.first;
  }
  return std::abs(twice) / 2;
}

TEST(Rasterise, ACubeCoversTheAreaOfItsProjection) {
  const testing::RandomScene scene = cube();
  for (const double field : {0.0, 40.0})
    for (const double elevation : {0.0, 20.0, 60.0, 90.0}) {
      Camera camera = looking(27, elevation);
      fit(camera, scene.points, 900, 700, 0.05, field);
      const VisibleMap map = rasterise(scene.points, scene.triangles, camera, 900, 700);
      const auto covered = static_cast<double>(
          std::count_if(map.triangle.begin(), map.triangle.end(), [](int t) { return t >= 0; }));
      std::vector<std::pair<double, double>> corners;
      for (const Vec3 p : scene.points) {
        const ScreenPoint s = camera.project(p);
        corners.emplace_back(s.x, s.y);
      }
      const double area = hull_area(corners);
      // The middles of pixels count: off by less than a pixel along the outline's 2,000 or so.
      EXPECT_NEAR(covered, area, 0.001 * area) << field << ' ' << elevation;
    }
}

TEST(Rasterise, ShowsWhatALineOfSightMeetsFirst) {
  std::mt19937 random(testing::test_seed());
  for (const double field : {0.0, 60.0}) {
    const testing::RandomScene scene = testing::random_scene(random, 400);
    Camera camera = looking(50, 25);
    fit(camera, scene.points, 320, 240, 0, field);
    const VisibleMap map = rasterise(scene.points, scene.triangles, camera, 320, 240);
    int compared = 0;
    for (int y = 0; y < 240; y += 3)
      for (int x = 0; x < 320; x += 3) {
        const Sight sight = camera.sight(x + 0.5, y + 0.5);
        std::int32_t first = -1;
        double nearest = 1e9, second = 1e9;
        bool near_an_edge = false;
        for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
          const testing::Meeting m = testing::meet(scene, t, sight);
          // Corners are rounded.
          near_an_edge =
              near_an_edge || testing::outline_distance(scene, t, camera, x + 0.5, y + 0.5) < 0.01;
          if (m.inside < 0) continue;
          second = std::min(second, std::max(nearest, m.t));
          if (m.t < nearest) {
            nearest = m.t;
            first = static_cast<std::int32_t>(t);
          }
        }
        if (near_an_edge || second - nearest < 0.02) continue;
        ++compared;
        const std::size_t pixel = map.at(x, y);
        ASSERT_EQ(map.triangle[pixel], first) << "seed " << testing::test_seed();
        if (first < 0) continue;
        const double depth = camera.depth(sight.origin + nearest * sight.direction);
        EXPECT_NEAR(map.nearness[pixel], field > 0 ? 1 / depth : -depth, field > 0 ? 1e-3 : 0.05);
      }
    EXPECT_GT(compared, 1500);
  }
}

TEST(Rasterise, ClipsWhatIsTooNear) {
  // The eye is above a plane that goes on behind it.
  const std::vector<Vec3> points{{-900, -900, 0}, {900, -900, 0}, {900, 900, 0}, {-900, 900, 0}};
  const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  Camera camera = looking(0, 10);
  camera.eye = {0, 0, 10};
  camera.is_perspective = true;
  camera.scale = 100;
  camera.middle_x = camera.middle_y = 50;
  camera.near_depth = 1;
  const VisibleMap map = rasterise(points, triangles, camera, 100, 100);
  for (int y = 0; y < 100; ++y) {
    const Sight sight = camera.sight(50.5, y + 0.5);
    const double t = -10 / sight.direction.z;
    const bool seen = sight.direction.z < 0 && t * sight.direction.y < 900;
    EXPECT_EQ(map.triangle[map.at(50, y)] >= 0, seen) << y;
  }
}

TEST(Rasterise, NeighboursLeaveNoGap) {
  // A fan of thin triangles that fills a square.
  testing::RandomScene scene;
  scene.points.emplace_back(0.137, 0.211, 0);
  for (int i = 0; i < 4000; ++i) {
    const double a = i * (8.0 / 4000);  // along the square's outline
    const double s = std::fmod(a, 2.0) - 1;
    const int side = static_cast<int>(a / 2);
    scene.points.emplace_back(side == 0   ? s
                              : side == 1 ? 1
                              : side == 2 ? -s
                                          : -1,
                              side == 0   ? -1
                              : side == 1 ? s
                              : side == 2 ? 1
                                          : -s,
                              0);
    scene.triangles.push_back({0, i + 1, (i + 1) % 4000 + 1});
  }
  Camera camera = looking(0, 90);
  fit(camera, scene.points, 333, 333, 0, 0);
  const VisibleMap map = rasterise(scene.points, scene.triangles, camera, 333, 333);
  EXPECT_EQ(std::count(map.triangle.begin(), map.triangle.end(), -1), 0);
}

TEST(Rasterise, IsTheSameWithAnyThreads) {
  std::mt19937 random(testing::test_seed());
  const testing::RandomScene scene = testing::random_scene(random, 3000);
  Camera camera = looking(50, 25);
  fit(camera, scene.points, 500, 400, 0, 30);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return rasterise(scene.points, scene.triangles, camera, 500, 400);
  };
  const VisibleMap one = with(1), four = with(4);
  EXPECT_EQ(one.triangle, four.triangle);
  EXPECT_EQ(one.nearness, four.nearness);
}

}  // namespace
}  // namespace tetropolis
