#include "terrain/ground_outliers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;
using Numbers = std::vector<std::uint32_t>;

void add_point(PointCloud& cloud, double x, double y, double z, std::uint8_t code = kGround) {
  cloud.push_back(x, y, z, code);
}

/// `per_m2` ground points per square metre on a square of side `size`, at height(x, y).
PointCloud terrain(double size, double per_m2, const std::function<double(double, double)>& height,
                   unsigned seed = test_seed()) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(0, size);
  std::normal_distribution<double> noise(0, 0.03);
  PointCloud cloud;
  for (int k = 0; k < static_cast<int>(size * size * per_m2); ++k) {
    const double x = along(random), y = along(random);
    add_point(cloud, x, y, height(x, y) + noise(random));
  }
  return cloud;
}

/// The definition, for clouds of at least 9 points in every neighbourhood of 4 m cells.
Numbers by_definition(const PointCloud& cloud, double x0, double y0) {
  const auto cell = [](double offset) { return static_cast<int>(offset / 4); };
  const auto square = [](double offset) { return static_cast<int>(std::floor(offset)); };
  Numbers outliers;
  for (std::uint32_t p = 0; p < cloud.size(); ++p) {
    const int ci = cell(cloud.x[p] - x0), cj = cell(cloud.y[p] - y0);
    Numbers near;
    for (std::uint32_t q = 0; q < cloud.size(); ++q)
      if (std::abs(cell(cloud.x[q] - x0) - ci) <= 1 && std::abs(cell(cloud.y[q] - y0) - cj) <= 1)
        near.push_back(q);
    EXPECT_GE(near.size(), 9U);
    const auto median = [&](const std::function<double(std::uint32_t)>& value) {
      std::vector<double> values;
      for (const std::uint32_t q : near) values.push_back(value(q));
      std::sort(values.begin(), values.end());
      return values[values.size() / 2];
    };
    const double middle = median([&](std::uint32_t q) { return cloud.z[q]; });
    const double spread = median([&](std::uint32_t q) { return std::abs(cloud.z[q] - middle); });
    const auto is_alone = [&](std::uint32_t r) {
      std::set<std::pair<int, int>> squares;
      for (const std::uint32_t q : near)
        if (std::abs(cloud.z[q] - cloud.z[r]) <= 1)
          squares.insert({square(cloud.x[q] - x0), square(cloud.y[q] - y0)});
      return squares.size() <= (near.size() >= 144 ? 3U : 1U);
    };
    const double off = cloud.z[p] - middle;
    if (std::abs(off) <= std::max(3.0, 6 * spread) || !is_alone(p)) continue;
    if (std::any_of(near.begin(), near.end(), [&](std::uint32_t q) {
          return (off > 0 ? cloud.z[q] > cloud.z[p] : cloud.z[q] < cloud.z[p]) && !is_alone(q);
        }))
      continue;
    outliers.push_back(p);
  }
  return outliers;
}

TEST(GroundOutliers, AgreeWithTheDefinition) {
  SCOPED_TRACE(test_seed());
  for (const double per_m2 : {0.5, 1.5}) {
    PointCloud cloud =
        terrain(40, per_m2, [](double x, double y) { return 0.1 * x + (y > 21 ? 7 : 0); });
    std::mt19937 random(test_seed());
    std::uniform_real_distribution<double> along(1, 39), z(-30, 40);
    for (int k = 0; k < 40; ++k) add_point(cloud, along(random), along(random), z(random));
    const double x0 = *std::min_element(cloud.x.begin(), cloud.x.end());
    const double y0 = *std::min_element(cloud.y.begin(), cloud.y.end());
    const Numbers expected = by_definition(cloud, x0, y0);
    EXPECT_GT(expected.size(), 10U);
    EXPECT_EQ(find_ground_outliers(cloud), expected);
  }
}

TEST(GroundOutliers, WithAnAnchorDoNotDependOnFarPoints) {
  SCOPED_TRACE(test_seed());
  PointCloud cloud = terrain(60, 1, [](double x, double) { return 0.1 * x; });
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> along(1, 59), z(-30, 40);
  for (int k = 0; k < 80; ++k) add_point(cloud, along(random), along(random), z(random));
  const Point2 anchor{101.3, -40.7};
  const Numbers alone = find_ground_outliers(cloud, anchor);
  EXPECT_EQ(alone, by_definition(cloud, 101.3 - 4 * 40, -40.7 - 4 * 5));
  const auto n = static_cast<std::uint32_t>(cloud.size());
  for (int k = 0; k < 100; ++k) add_point(cloud, -333.7 - k, -771.9, 100);
  Numbers beside = find_ground_outliers(cloud, anchor);
  std::erase_if(beside, [&](std::uint32_t p) { return p >= n; });
  EXPECT_EQ(beside, alone);
}

TEST(GroundOutliers, BirdsAndPitsAreFoundAndNothingElse) {
  for (const double per_m2 : {0.05, 0.5, 5.0}) {
    PointCloud cloud = terrain(120, per_m2, [](double x, double y) {
      return 50 + 15 * std::sin(x / 25) * std::cos(y / 30);
    });
    const auto first = static_cast<std::uint32_t>(cloud.size());
    add_point(cloud, 60, 60, 1e5);
    add_point(cloud, 30, 70, -60);
    add_point(cloud, 90, 20, 150);
    add_point(cloud, 91, 50, -9999);
    add_point(cloud, 5, 5, 250, kBuildingClass);  // no ground point
    EXPECT_EQ(find_ground_outliers(cloud), (Numbers{first, first + 1, first + 2, first + 3}))
        << per_m2;
  }
}

TEST(GroundOutliers, PointsThatAreThereTwiceAreFoundTwice) {
  PointCloud cloud = terrain(50, 2, [](double, double) { return 3; });
  const std::size_t once = cloud.size();
  add_point(cloud, 25, 25, 30);
  add_point(cloud, 40, 10, -8);
  for (std::size_t p = 0; p < once + 2; ++p) add_point(cloud, cloud.x[p], cloud.y[p], cloud.z[p]);
  const auto n = static_cast<std::uint32_t>(once);
  EXPECT_EQ(find_ground_outliers(cloud), (Numbers{n, n + 1, 2 * n + 2, 2 * n + 3}));
}

TEST(GroundOutliers, WallsCliffsAndQuaysStay) {
  const std::vector<std::function<double(double, double)>> grounds = {
      [](double x, double) { return x < 31.7 ? 20.0 : 0.0; },               // quarry wall
      [](double x, double y) { return x < 30 && y < 30 ? 20.0 : 0.0; },     // its corner
      [](double x, double y) { return x > 53 && y > 53 ? -12.0 : 0.0; },    // at the rim
      [](double x, double) { return std::abs(x - 30) < 1.5 ? 4.0 : 0.0; },  // dyke
      [](double x, double y) { return x - 0.3 * y; },                       // 46 degrees
      [](double x, double y) {
        return std::hypot(x - 30, y - 30) < 3.5 ? -8.0 : 0.0;  // a shaft
      }};
  for (std::size_t k = 0; k < grounds.size(); ++k)
    for (const double per_m2 : {0.5, 4.0}) {
      const PointCloud cloud = terrain(60, per_m2, grounds[k]);
      EXPECT_EQ(find_ground_outliers(cloud), Numbers{}) << k << " " << per_m2;
    }
}

TEST(GroundOutliers, PointsOnAWallAreBetweenThoseThatAreNotAlone) {
  PointCloud cloud = terrain(
      40, 3, [](double x, double y) { return std::hypot(x - 20, y - 20) < 3 ? -10.0 : 0.0; });
  add_point(cloud, 17, 20, -5);  // halfway down the shaft
  add_point(cloud, 23, 20, -3.5);
  EXPECT_EQ(find_ground_outliers(cloud), Numbers{});
}

TEST(GroundOutliers, ManyPointsAtOnePlaceTakeNoLonger) {
  // A mast of 100,000 points; squared, they would take hours.
  PointCloud cloud = terrain(40, 3, [](double, double) { return 1; });
  const auto first = static_cast<std::uint32_t>(cloud.size());
  Numbers mast;
  for (std::uint32_t k = 0; k < 100000; ++k) {
    add_point(cloud, 20.2, 20.2, 10 + 0.0005 * k);
    mast.push_back(first + k);
  }
  // Against the median, which it would be itself, the ground has to be denser around.
  for (int k = 0; k < 250000; ++k)
    add_point(cloud, 16 + 0.00003 * k, 17 + (k % 8), 1 + 0.01 * (k % 7));
  EXPECT_EQ(find_ground_outliers(cloud), mast);
  // A platform around its top is not alone, and what is below that is between.
  for (int k = 0; k < 8; ++k) add_point(cloud, 17 + k, 20, 61.5);
  EXPECT_EQ(find_ground_outliers(cloud), Numbers{});
}

TEST(GroundOutliers, AFewPointsCannotBeJudged) {
  PointCloud cloud;
  EXPECT_EQ(find_ground_outliers(cloud), Numbers{});
  for (int k = 0; k < 8; ++k) add_point(cloud, k, k, k == 3 ? 1000 : 0);
  EXPECT_EQ(find_ground_outliers(cloud), Numbers{});
  add_point(cloud, 9, 1, 0);
  EXPECT_EQ(find_ground_outliers(cloud), Numbers{3});
}

TEST(GroundOutliers, TheSameForAnyNumberOfThreads) {
  PointCloud cloud = terrain(200, 1, [](double x, double y) { return x * y / 500; });
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> along(0, 200), z(-100, 300);
  for (int k = 0; k < 300; ++k) add_point(cloud, along(random), along(random), z(random));
  Numbers one;
  {
    const ThreadLimit limit(1);
    one = find_ground_outliers(cloud);
  }
  const ThreadLimit limit(4);
  EXPECT_EQ(find_ground_outliers(cloud), one);
  EXPECT_GT(one.size(), 100U);
  EXPECT_THROW(find_ground_outliers(cloud, {}, {{}, [] { return true; }}), Cancelled);
}

}  // namespace
}  // namespace tetropolis
