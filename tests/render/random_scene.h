// Triangles at random, and what a ray meets of them: the slow way.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "render/camera.h"

namespace tetropolis::testing {

struct RandomScene {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// `count` triangles in a cube of 20 m, of all sizes.
inline RandomScene random_scene(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> place(-10, 10), size(0.1, 6);
  RandomScene scene;
  for (int t = 0; t < count; ++t) {
    const Vec3 middle{place(random), place(random), place(random)};
    const double s = size(random);
    std::array<std::int32_t, 3> corners{};
    for (std::int32_t& corner : corners) {
      corner = static_cast<std::int32_t>(scene.points.size());
      scene.points.push_back(middle + (s / 10) * Vec3{place(random), place(random), place(random)});
    }
    scene.triangles.push_back(corners);
  }
  return scene;
}

/// What a line of sight meets of a triangle (Moeller, Trumbore 1997).
struct Meeting {
  double t = -1;       ///< Along the sight; negative: nothing.
  double inside = -1;  ///< The least of the three weights of the corners there.
};

inline Meeting meet(const RandomScene& scene, std::size_t triangle, const Sight& sight) {
  const auto p = [&](std::size_t i) {
    return scene.points[static_cast<std::size_t>(scene.triangles[triangle][i])];
  };
  const Vec3 e1 = p(1) - p(0), e2 = p(2) - p(0), h = cross(sight.direction, e2);
  const double determinant = dot(e1, h);
  if (std::abs(determinant) < 1e-12) return {};
  const Vec3 s = sight.origin - p(0), q = cross(s, e1);
  const double u = dot(s, h) / determinant, v = dot(sight.direction, q) / determinant;
  return {dot(e2, q) / determinant, std::min({u, v, 1 - u - v})};
}

/// How far (x, y) is from the outline of the triangle as `camera` sees it, pixels.
inline double outline_distance(const RandomScene& scene, std::size_t triangle, const Camera& camera,
                               double x, double y) {
  double least = 1e9;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = [&](std::size_t k) {
      const auto v = static_cast<std::size_t>(scene.triangles[triangle][k % 3]);
      const ScreenPoint s = camera.project(scene.points[v]);
      return Point2{s.x, s.y};
    };
    least = std::min(least, distance_to_segment({x, y}, at(i), at(i + 1)));
  }
  return least;
}

}  // namespace tetropolis::testing
