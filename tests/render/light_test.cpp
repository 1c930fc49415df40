#include "render/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "random_scene.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

Receiver receiver(Vec3 p, Vec3 n) {
  const auto f = [](Vec3 v) {
    return std::array{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  return {f(p), f(n), 0};
}

TEST(Light, AnOpenSkyIsOneOnTheGroundAndHalfOnWalls) {
  const std::vector<Vec3> points{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}};
  const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}};
  std::vector<std::vector<Receiver>> receivers{
      {receiver({0, 0, 0}, {0, 0, 1}), receiver({0, 0, 0}, {0.6, 0.8, 0})}};
  illuminate(points, triangles, sky_lights(), 64, receivers);
  EXPECT_NEAR(receivers[0][0].light, 1, 1e-5);
  EXPECT_NEAR(receivers[0][1].light, 0.5, 0.03);  // of 48 directions
}

TEST(Light, ReachesWhatNothingIsBeforeOf) {
  std::mt19937 random(testing::test_seed());
  const testing::RandomScene scene = testing::random_scene(random, 150);
  const std::vector<FarLight> sun = sun_lights(200, 40);
  std::uniform_real_distribution<double> place(-9, 9);
  std::vector<std::vector<Receiver>> receivers(1);
  std::vector<float> expected;
  int dark = 0;
  while (receivers[0].size() < 400) {
    const Vec3 p{place(random), place(random), place(random)};
    float light = 0;
    bool near_an_edge = false;
    for (const FarLight& part : sun) {
      Camera towards;  // at the receiver
      towards.eye = p;
      towards.forward = part.towards;
      towards.right = normalised(cross(part.towards, {0, 0, 1}));
      towards.up = cross(towards.right, towards.forward);
      bool is_lit = true;
      for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const testing::Meeting m = testing::meet(scene, t, {p, part.towards});
        // A map's pixel is less than 2 cm; the map looks from 1.5 of them above.
        near_an_edge = near_an_edge || std::abs(m.t) < 0.5 ||
                       testing::outline_distance(scene, t, towards, 0, 0) < 0.08;
        if (m.inside >= 0 && m.t > 0) is_lit = false;
      }
      if (is_lit) light += part.strength * static_cast<float>(std::max(0.0, part.towards.z));
    }
    if (near_an_edge) continue;
    receivers[0].push_back(receiver(p, {0, 0, 1}));
    expected.push_back(light);
    dark += light < 0.1F ? 1 : 0;
  }
  EXPECT_GT(dark, 20);
  illuminate(scene.points, scene.triangles, sun, 2048, receivers);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(receivers[0][i].light, expected[i], 1e-3) << "seed " << testing::test_seed();
}

TEST(Light, TheSunStandsWhereTheCompassSays) {
  Vec3 sum;
  double strength = 0;
  for (const FarLight& part : sun_lights(135, 30)) {
    sum = sum + static_cast<double>(part.strength) * part.towards;
    strength += static_cast<double>(part.strength);
  }
  EXPECT_NEAR(strength, 1, 1e-6);
  const Vec3 middle = normalised(sum);
  EXPECT_NEAR(middle.z, 0.5, 0.005);
  EXPECT_NEAR(middle.x, -middle.y, 0.02);  // south-east
  EXPECT_GT(middle.x, 0);
}

}  // namespace
}  // namespace tetropolis
