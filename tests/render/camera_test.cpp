#include "render/camera.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

std::vector<Vec3> random_points(std::mt19937& random) {
  std::uniform_real_distribution<double> x(-300, 500), y(100, 400), z(-5, 80);
  std::vector<Vec3> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(x(random), y(random), z(random));
  return points;
}

TEST(Camera, LooksWhereTheCompassSays) {
  const Camera east = looking(90, 0);
  EXPECT_NEAR(east.forward.x, 1, 1e-12);
  EXPECT_NEAR(dot(east.right, {0, -1, 0}), 1, 1e-12);  // south is at the right
  const Camera down = looking(0, 90);
  EXPECT_NEAR(down.forward.z, -1, 1e-12);
  EXPECT_NEAR(down.right.x, 1, 1e-12);
  EXPECT_NEAR(down.up.y, 1, 1e-12);  // north up
}

TEST(Camera, FitsAllPointsTightlyInsideTheMargin) {
  std::mt19937 random(testing::test_seed());
  for (const double field : {0.0, 26.0, 70.0})
    for (const double azimuth : {0.0, 33.0, 200.0}) {
      SCOPED_TRACE(testing::test_seed());
      const std::vector<Vec3> points = random_points(random);
      Camera camera = looking(azimuth, 35);
      fit(camera, points, 800, 500, 0.05, field);
      double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
      for (const Vec3 p : points) {
        const ScreenPoint s = camera.project(p);
        left = std::min(left, s.x);
        right = std::max(right, s.x);
        top = std::min(top, s.y);
        bottom = std::max(bottom, s.y);
      }
      EXPECT_GE(left, 40 - 1e-6);
      EXPECT_LE(right, 760 + 1e-6);
      EXPECT_GE(top, 25 - 1e-6);
      EXPECT_LE(bottom, 475 + 1e-6);
      // One of the two directions is full.
      const bool is_full =
          (left < 40 + 1e-3 && right > 760 - 1e-3) || (top < 25 + 1e-3 && bottom > 475 - 1e-3);
      EXPECT_TRUE(is_full) << left << ' ' << right << ' ' << top << ' ' << bottom;
    }
}

TEST(Camera, SightsPassThePointsThatAreSeenThere) {
  std::mt19937 random(testing::test_seed());
  for (const double field : {0.0, 26.0}) {
    const std::vector<Vec3> points = random_points(random);
    Camera camera = looking(120, 20);
    fit(camera, points, 800, 500, 0.05, field);
    if (field == 0) camera.up = 1.3 * camera.up;  // as sections stretch heights
    for (const Vec3 p : points) {
      const ScreenPoint s = camera.project(p);
      const Sight sight = camera.sight(s.x, s.y);
      const Vec3 off = cross(p - sight.origin, normalised(sight.direction));
      EXPECT_LT(dot(off, off), 1e-12) << "seed " << testing::test_seed();
    }
  }
}

}  // namespace
}  // namespace tetropolis
