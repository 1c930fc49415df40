#include "tetropolis/volume/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/parallel.h"

#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

TEST(Quality, KnownTetrahedra) {
  const double h = 1 / std::sqrt(2.0);
  const TetShape regular = tet_shape({1, 0, -h}, {-1, 0, -h}, {0, 1, h}, {0, -1, h});
  EXPECT_NEAR(regular.min_dihedral_deg, std::acos(1.0 / 3) * kDegrees, 1e-9);
  EXPECT_NEAR(regular.max_dihedral_deg, std::acos(1.0 / 3) * kDegrees, 1e-9);
  EXPECT_NEAR(regular.aspect_ratio, 1, 1e-12);
  EXPECT_NEAR(std::abs(regular.volume), 8 / (6 * std::sqrt(2.0)), 1e-12);

  const TetShape corner = tet_shape({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_NEAR(corner.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(corner.max_dihedral_deg, 90, 1e-9);
  EXPECT_NEAR(corner.min_dihedral_deg, std::acos(1 / std::sqrt(3.0)) * kDegrees, 1e-9);

  const TetShape mirrored = tet_shape({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_NEAR(mirrored.volume, -1.0 / 6, 1e-15);
  const TetShape flat = tet_shape({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  EXPECT_EQ(flat.volume, 0);
  EXPECT_TRUE(std::isinf(flat.aspect_ratio));
}

TEST(Quality, QuantilesAreThoseOfTheSortedValues) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> coordinate(0, 1);
  QualityHistogram histogram;
  std::vector<double> angles, aspects;
  for (int i = 0; i < 20000; ++i) {
    const auto p = [&] {
      return Point3{coordinate(random), coordinate(random), coordinate(random)};
    };
    const TetShape shape = tet_shape(p(), p(), p(), p());
    histogram.add(shape);
    angles.push_back(shape.min_dihedral_deg);
    aspects.push_back(shape.aspect_ratio);
  }
  std::sort(angles.begin(), angles.end());
  std::sort(aspects.begin(), aspects.end());
  for (const double share : {0.0001, 0.001, 0.01, 0.5, 0.99}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * 20000)) - 1;
    EXPECT_NEAR(histogram.dihedral_quantile_deg(share), angles[rank], 0.0051);
    EXPECT_NEAR(histogram.aspect_quantile(share) / aspects[rank], 1, 0.002);
  }
  EXPECT_EQ(histogram.min_dihedral_deg(), angles.front());
  EXPECT_EQ(histogram.max_aspect_ratio(), aspects.back());
}

TEST(Quality, SumsOverAMeshDoNotDependOnThreads) {
  const auto result = testing::meshed(testing::small_city([](double, double) { return 0.0; }));
  std::vector<double> volumes;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const QualityHistogram quality = measure_quality(result.mesh);
    EXPECT_EQ(quality.cells(), cell_count(result.mesh));
    volumes.push_back(quality.volume());
  }
  EXPECT_EQ(volumes[0], volumes[1]);
  // The domain's box less the buildings' prisms.
  double expected = 120 * 90 * result.mesh.column(0)[result.mesh.layers];
  const std::vector<double> areas{18 * 12, 15.5 * 25, 35 * 40 - 15 * 20, 42, 0};
  for (std::size_t b = 0; b < 4; ++b) expected -= areas[b] * result.city.roofs[b];
  double last = 0;
  const Ring& ring = result.city.footprints[4].outer;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 u = ring[i], v = ring[(i + 1) % ring.size()];
    last += (u.x * v.y - v.x * u.y) / 2;
  }
  expected -= last * result.city.roofs[4];
  EXPECT_NEAR(volumes[0] / expected, 1, 1e-12);
}

}  // namespace
}  // namespace tetropolis
