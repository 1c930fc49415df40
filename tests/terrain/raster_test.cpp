#include "tetropolis/terrain/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

Raster make_raster(std::int32_t nx, std::int32_t ny, double step) {
  Raster raster{nx, ny, 10.5, -3.25, step, {}};
  raster.values.resize(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
  return raster;
}

TEST(Raster, SampleReproducesBilinearFunctions) {
  Raster raster = make_raster(7, 5, 0.75);
  const auto f = [](double x, double y) { return 3 + 0.5 * x - 0.25 * y; };
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i)
      raster.values[static_cast<std::size_t>(j * raster.nx + i)] =
          f(raster.x0 + i * raster.step, raster.y0 + j * raster.step);
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> share(0, 1);
  const Bounds2 box = raster.bounds();
  for (int k = 0; k < 1000; ++k) {
    const Point2 p{box.xmin + share(random) * box.width(), box.ymin + share(random) * box.height()};
    EXPECT_NEAR(sample(raster, p), f(p.x, p.y), 1e-12) << "seed " << test_seed();
  }
}

TEST(Raster, SampleAtNodesAndBetween) {
  Raster raster = make_raster(3, 2, 1);
  raster.values = {1, 2, 4, 8, 16, 32};
  for (std::int32_t j = 0; j < 2; ++j)
    for (std::int32_t i = 0; i < 3; ++i)
      EXPECT_EQ(sample(raster, {raster.x0 + i, raster.y0 + j}), raster.at(i, j));
  EXPECT_EQ(sample(raster, {raster.x0 + 0.5, raster.y0}), 1.5);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const Point2 p : {Point2{kNaN, raster.y0}, Point2{raster.x0, kNaN}, Point2{kNaN, kNaN}})
    EXPECT_TRUE(std::isnan(sample(raster, p)));
  EXPECT_EQ(sample(raster, {raster.x0, raster.y0 + 0.5}), 4.5);
  EXPECT_EQ(sample(raster, {raster.x0 + 1.5, raster.y0 + 0.5}), (2 + 4 + 16 + 32) / 4.0);
}

TEST(Raster, SampleOutsideTakesTheRim) {
  Raster raster = make_raster(3, 2, 1);
  raster.values = {1, 2, 4, 8, 16, 32};
  EXPECT_EQ(sample(raster, {-1e9, -1e9}), 1);
  EXPECT_EQ(sample(raster, {1e9, -1e9}), 4);
  EXPECT_EQ(sample(raster, {1e9, 1e9}), 32);
  EXPECT_EQ(sample(raster, {raster.x0 + 0.5, -1e9}), 1.5);
}

TEST(Raster, SampleOfSingleNodeRowOrColumn) {
  Raster node = make_raster(1, 1, 1);
  node.values = {7};
  EXPECT_EQ(sample(node, {0, 0}), 7);
  Raster row = make_raster(3, 1, 2);
  row.values = {1, 3, 5};
  EXPECT_EQ(sample(row, {row.x0 + 1, 99}), 2);
  Raster column = make_raster(1, 3, 2);
  column.values = {1, 3, 5};
  EXPECT_EQ(sample(column, {99, column.y0 + 3}), 4);
}

TEST(Raster, RoundingToSingleMovesNothingByMoreThanItsLastDigit) {
  Raster raster{3, 1, 0, 0, 1, {0.1, -511.9999, 4095.123}};
  const std::vector<double> before = raster.values;
  round_to_single(raster);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NE(raster.values[i], before[i]);
    EXPECT_EQ(raster.values[i], static_cast<double>(static_cast<float>(raster.values[i])));
    EXPECT_NEAR(raster.values[i], before[i], std::abs(before[i]) * 0x1p-24);
  }
}

TEST(Raster, HighestUnderABoxIsThatOfItsCells) {
  Raster raster = make_raster(40, 30, 2.5);
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> height(-50, 50), share(-0.3, 1.3);
  for (double& z : raster.values) z = height(random);
  const Bounds2 all = raster.bounds();
  for (int k = 0; k < 200; ++k) {
    const auto x = [&] { return all.xmin + share(random) * all.width(); };
    const auto y = [&] { return all.ymin + share(random) * all.height(); };
    const double x0 = x(), x1 = x(), y0 = y(), y1 = y();
    const Bounds2 box{std::min(x0, x1), std::min(y0, y1), std::max(x0, x1), std::max(y0, y1)};
    if (!box.intersects(all)) continue;
    // A cell meets the box if it comes nearer to it than not at all.
    double highest = -1e9;
    for (std::int32_t j = 0; j + 1 < raster.ny; ++j)
      for (std::int32_t i = 0; i + 1 < raster.nx; ++i) {
        const Bounds2 cell{raster.x0 + i * 2.5, raster.y0 + j * 2.5, raster.x0 + (i + 1) * 2.5,
                           raster.y0 + (j + 1) * 2.5};
        if (!cell.intersects(box)) continue;
        for (const std::int32_t n : {0, 1})
          for (const std::int32_t m : {0, 1}) highest = std::max(highest, raster.at(i + n, j + m));
      }
    EXPECT_EQ(highest_under(raster, box), highest) << "seed " << test_seed() << ", box " << k;
  }
  EXPECT_EQ(highest_under(raster, {1e6, 1e6, 2e6, 2e6}), raster.at(39, 29));
}

}  // namespace
}  // namespace tetropolis
