#include "volume/quality/prism_shape.h"

#include <array>
#include <cstddef>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/vec3.h"

namespace tetropolis {
namespace {

using Corners = std::array<Point3, 3>;

/// Of tets or triangles: the sum of what their measures weigh.
struct Weighted {
  double sum = 0;
  Point3 moment{};

  void add(double weight, const Point3& at) {
    sum += weight;
    for (std::size_t c = 0; c < 3; ++c) moment[c] += weight * at[c];
  }
  Point3 centre() const { return {moment[0] / sum, moment[1] / sum, moment[2] / sum}; }
};

Point3 centre_of_triangle(const Point3& a, const Point3& b, const Point3& c) {
  return {(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3};
}

void expect_near(const Point3& a, const Point3& b) {
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-9);
}

std::pair<Corners, Corners> random_prism(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Corners low{{{unit(random), unit(random), 0}, {5 + unit(random), unit(random), 0}, {2, 4, 0}}};
  Corners high;
  for (std::size_t i = 0; i < 3; ++i) {
    low[i][2] = 6 * unit(random);
    high[i] = {low[i][0], low[i][1], low[i][2] + 0.1 + 3 * unit(random)};
  }
  return {low, high};
}

TEST(PrismShape, VolumeAndCentreAreThoseOfTets) {
  std::mt19937 random(7);
  for (int k = 0; k < 100; ++k) {
    const auto [low, high] = random_prism(random);
    Weighted tets;
    for (const std::array<Point3, 4>& p : {std::array{low[0], low[1], low[2], high[0]},
                                           {low[1], high[1], low[2], high[0]},
                                           {low[2], high[1], high[2], high[0]}}) {
      const double volume = dot(cross(minus(p[1], p[0]), minus(p[2], p[0])), minus(p[3], p[0])) / 6;
      ASSERT_GT(volume, 0);
      tets.add(volume, centre_of(p));
    }
    const Prism prism = prism_between(low, high);
    EXPECT_NEAR(prism.volume, tets.sum, 1e-9);
    expect_near(prism.centre, tets.centre());
  }
}

TEST(PrismShape, FacesAreThoseOfTheirTrianglesAndClosed) {
  std::mt19937 random(8);
  for (int k = 0; k < 100; ++k) {
    const auto [low, high] = random_prism(random);
    const Prism prism = prism_between(low, high);
    Point3 sum{};
    for (const PrismFace& face : prism.faces) {
      Weighted triangles;
      Point3 area{};
      for (std::size_t i = 1; i + 1 < face.count; ++i) {
        const Point3 &a = face.corners[0], &b = face.corners[i], &c = face.corners[i + 1];
        const Point3 twice = cross(minus(b, a), minus(c, a));
        for (std::size_t j = 0; j < 3; ++j) area[j] += twice[j] / 2;
        triangles.add(length(twice), centre_of_triangle(a, b, c));
      }
      expect_near(face.area, area);
      expect_near(face.centre, triangles.centre());
      EXPECT_NEAR(face.flatness, 1, 1e-12);
      EXPECT_GT(dot(face.area, minus(face.centre, prism.centre)), 0);
      for (std::size_t j = 0; j < 3; ++j) sum[j] += face.area[j];
    }
    expect_near(sum, {});
  }
}

}  // namespace
}  // namespace tetropolis
