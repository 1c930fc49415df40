#include "light.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/units.h"

namespace tetropolis {

namespace {

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

/// The share of the four pixels around (x, y) in which nothing is nearer to the light.
float share_lit(const VisibleMap& map, float x, float y, float nearness) {
  const float column = std::clamp(x - 0.5F, 0.0F, static_cast<float>(map.width) - 1.01F);
  const float row = std::clamp(y - 0.5F, 0.0F, static_cast<float>(map.height) - 1.01F);
  const int i = static_cast<int>(column), j = static_cast<int>(row);
  const float u = column - static_cast<float>(i), v = row - static_cast<float>(j);
  const float* above = map.nearness.data() + map.at(i, j);
  const float* below = above + map.width;
  const auto lit = [&](float blocker) { return blocker <= nearness ? 1.0F : 0.0F; };
  return (1 - v) * ((1 - u) * lit(above[0]) + u * lit(above[1])) +
         v * ((1 - u) * lit(below[0]) + u * lit(below[1]));
}

/// In single precision.
struct Row {
  float x, y, z, shift;

  Row(Vec3 v, double shift_)
      : x(static_cast<float>(v.x)),
        y(static_cast<float>(v.y)),
        z(static_cast<float>(v.z)),
        shift(static_cast<float>(shift_)) {}
  float operator()(float px, float py, float pz) const { return x * px + y * py + z * pz + shift; }
};

void add_light(const FarLight& light, const Camera& camera, const VisibleMap& map,
               std::vector<Receiver>& receivers) {
  // A surface does not shade itself: it is looked at from a pixel and a half above it.
  const double height = 1.5 / camera.scale;
  const auto above = static_cast<float>(height);
  const Row towards(light.towards, 0);
  const Vec3 right = camera.scale * camera.right, up = -camera.scale * camera.up;
  const Row column(right, camera.middle_x - dot(camera.eye, right));
  const Row row(up, camera.middle_y - dot(camera.eye, up));
  const Row near(-1.0 * camera.forward, dot(camera.eye, camera.forward) + 0.5 * height);
  for (Receiver& r : receivers) {
    const float facing = towards(r.normal[0], r.normal[1], r.normal[2]);
    if (facing <= 0) continue;
    const float x = r.position[0] + above * r.normal[0], y = r.position[1] + above * r.normal[1];
    const float z = r.position[2] + above * r.normal[2];
    r.light +=
        light.strength * facing * share_lit(map, column(x, y, z), row(x, y, z), near(x, y, z));
  }
}

}  // namespace

std::vector<FarLight> sun_lights(double azimuth, double elevation) {
  constexpr int kCount = 12;
  constexpr double kRadius = to_radians(1.1);  // four times the sun's: a softer edge
  const double a = to_radians(azimuth), e = to_radians(elevation);
  const Vec3 sun{std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
  const Vec3 right{std::cos(a), -std::sin(a), 0}, up = cross(right, sun);
  std::vector<FarLight> lights;
  for (int i = 0; i < kCount; ++i) {
    const double radius = kRadius * std::sqrt((i + 0.5) / kCount), turn = i * kGoldenAngle;
    lights.push_back(
        {normalised(sun + (radius * std::cos(turn)) * right + (radius * std::sin(turn)) * up),
         1.0F / kCount});
  }
  return lights;
}

std::vector<FarLight> sky_lights() {
  constexpr int kCount = 48;
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

void illuminate(std::span<const Vec3> points, Triangles triangles, std::span<const FarLight> lights,
                int map_size, std::span<std::vector<Receiver>> receivers) {
  for (const FarLight& light : lights) {
    const Camera camera = camera_at(light.towards, points, map_size);
    const VisibleMap map = rasterise(points, triangles, camera, map_size, map_size, false);
    parallel_chunks(receivers.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) add_light(light, camera, map, receivers[i]);
    });
  }
}

}  // namespace tetropolis
