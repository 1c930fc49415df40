#include "light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr double kRadians = std::numbers::pi / 180;

/// Directions that are spread evenly: turned by the golden angle from one to the next.
constexpr double kGoldenAngle = 2.39996322972865332;

/// A camera that looks from a light at all points.
Camera camera_at(Vec3 towards, std::span<const Vec3> points, int size) {
  Camera camera;
  camera.forward = -1.0 * towards;
  const Vec3 aside = std::abs(towards.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  camera.right = normalised(cross(camera.forward, aside));
  camera.up = cross(camera.right, camera.forward);
  constexpr double kMargin = 0.01;
  fit(camera, points, size, size, kMargin, 0);
  return camera;
}

/// The share of the four pixels around (x, y), by their nearness to it, that nothing is nearer to
/// the light in.
float share_lit(const VisibleMap& map, double x, double y, float nearness) {
  const double column = std::clamp(x - 0.5, 0.0, map.width - 1.001);
  const double row = std::clamp(y - 0.5, 0.0, map.height - 1.001);
  const int i = static_cast<int>(column), j = static_cast<int>(row);
  const auto u = static_cast<float>(column - i), v = static_cast<float>(row - j);
  const float* above = map.nearness.data() + map.at(i, j);
  const float* below = above + map.width;
  const auto lit = [&](float blocker) { return blocker <= nearness ? 1.0F : 0.0F; };
  return (1 - v) * ((1 - u) * lit(above[0]) + u * lit(above[1])) +
         v * ((1 - u) * lit(below[0]) + u * lit(below[1]));
}

void add_light(const FarLight& light, const Camera& camera, const VisibleMap& map,
               std::vector<Receiver>& receivers) {
  // A surface does not shade itself: looked at from a pixel and a half above it.
  const double above = 1.5 / camera.scale;
  for (Receiver& r : receivers) {
    const Vec3 n{r.normal[0], r.normal[1], r.normal[2]};
    const double facing = dot(n, light.towards);
    if (facing <= 0) continue;
    const Vec3 p{r.position[0], r.position[1], r.position[2]};
    const ScreenPoint at = camera.project(p + above * n);
    const auto nearness = static_cast<float>(at.nearness + 0.5 * above);
    r.light += light.strength * static_cast<float>(facing) * share_lit(map, at.x, at.y, nearness);
  }
}

}  // namespace

std::vector<FarLight> sun_lights(double azimuth, double elevation) {
  constexpr int kCount = 16;
  constexpr double kRadius = 1.1 * kRadians;  // four times the sun's: a softer edge
  const double a = azimuth * kRadians, e = elevation * kRadians;
  const Vec3 sun{std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
  const Vec3 right{std::cos(a), -std::sin(a), 0}, up = cross(right, sun);
  std::vector<FarLight> lights;
  for (int i = 0; i < kCount; ++i) {
    const double radius = kRadius * std::sqrt((i + 0.5) / kCount), turn = i * kGoldenAngle;
    lights.push_back({normalised(sun + (radius * std::cos(turn)) * right +
                                 (radius * std::sin(turn)) * up),
                      1.0F / kCount});
  }
  return lights;
}

std::vector<FarLight> sky_lights() {
  constexpr int kCount = 56;
  std::vector<FarLight> lights;
  double level = 0;
  for (int i = 0; i < kCount; ++i) {
    const double z = (i + 0.5) / kCount, turn = i * kGoldenAngle, r = std::sqrt(1 - z * z);
    lights.push_back({{r * std::cos(turn), r * std::sin(turn), z}, 1});
    level += z;
  }
  for (FarLight& light : lights) light.strength = static_cast<float>(1 / level);
  return lights;
}

void illuminate(std::span<const Vec3> points, Triangles triangles,
                std::span<const FarLight> lights, int map_size,
                std::span<std::vector<Receiver>> receivers) {
  for (const FarLight& light : lights) {
    const Camera camera = camera_at(light.towards, points, map_size);
    const VisibleMap map = rasterise(points, triangles, camera, map_size, map_size, false);
    parallel_chunks(receivers.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) add_light(light, camera, map, receivers[i]);
    });
  }
}

}  // namespace tetropolis
