#include "terrain/fill_smoothly.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "core/infinity.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

Raster empty_raster(std::int32_t nx, std::int32_t ny) {
  return {nx, ny, 3.5, -8, 2, std::vector<double>(row_major(0, ny, nx), kNaN)};
}

/// Of the heights of neighbouring nodes.
double steepest(const Raster& raster) {
  double most = 0;
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i) {
      if (i > 0) most = std::max(most, std::abs(raster.at(i, j) - raster.at(i - 1, j)));
      if (j > 0) most = std::max(most, std::abs(raster.at(i, j) - raster.at(i, j - 1)));
    }
  return most;
}

/// Wherever the grid begins: two squares of 5 nodes, 100 nodes apart, 50 m different.
TEST(FillSmoothly, RunsFromOneHeightToTheNextWithoutASteepPlace) {
  for (std::int32_t shift = 0; shift < 64; ++shift) {
    SCOPED_TRACE(shift);
    Raster raster = empty_raster(260, 150);
    for (std::int32_t j = 70; j < 75; ++j)
      for (std::int32_t i = 0; i < 5; ++i) {
        raster.values[row_major(i + 40 + shift, j, raster.nx)] = 400;
        raster.values[row_major(i + 140 + shift, j, raster.nx)] = 450;
      }
    fill_smoothly(raster);
    EXPECT_LE(steepest(raster), 4 * 50.0 / 95);
    EXPECT_NEAR(raster.at(92 + shift, 72), 425, 20);
    EXPECT_EQ(raster.at(42 + shift, 72), 400);
    EXPECT_EQ(raster.at(142 + shift, 72), 450);
  }
}

TEST(FillSmoothly, KeepsWhatIsKnownAndStaysBetween) {
  std::mt19937 random(test_seed());
  for (int round = 0; round < 30; ++round) {
    SCOPED_TRACE(test_seed());
    const auto size = [&] { return std::uniform_int_distribution<std::int32_t>(1, 90)(random); };
    Raster raster = empty_raster(size(), size());
    std::uniform_real_distribution<double> height(-20, 300);
    double low = 1e9, high = -1e9;
    for (std::size_t k = 0; k < 1 + raster.values.size() / 50; ++k) {
      double& z = raster.values[std::uniform_int_distribution<std::size_t>(
          0, raster.values.size() - 1)(random)];
      z = height(random);
    }
    for (const double z : raster.values)
      if (!std::isnan(z)) low = std::min(low, z), high = std::max(high, z);
    const Raster before = raster;
    Raster alone = raster;
    fill_smoothly(raster);
    for (std::size_t node = 0; node < raster.values.size(); ++node) {
      ASSERT_TRUE(raster.values[node] >= low - 1e-9 && raster.values[node] <= high + 1e-9);
      const double known = before.values[node];
      ASSERT_TRUE(std::isnan(known) || raster.values[node] == known);
    }
    const ThreadLimit limit(1);
    fill_smoothly(alone);
    EXPECT_EQ(alone.values, raster.values);
  }
}

}  // namespace
}  // namespace tetropolis
