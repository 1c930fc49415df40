// RadiusSearch around points, and how many points are looked at.
#include "city/radius_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

/// Points in a box from the origin.
struct Scan {
  PointCloud cloud;
  std::vector<PointIndex> points;
  std::mt19937 random{test_seed()};

  void add(int n, double width, double height) {
    std::uniform_real_distribution<double> share(0, 1);
    for (int k = 0; k < n; ++k) {
      points.push_back(static_cast<PointIndex>(cloud.size()));
      cloud.x.push_back(width * share(random));
      cloud.y.push_back(height * share(random));
      cloud.z.push_back(10 * share(random));
      cloud.classification.push_back(kUnclassified);
    }
  }
  double distance(std::size_t a, std::size_t b) const {
    return std::hypot(cloud.x[a] - cloud.x[b], cloud.y[a] - cloud.y[b]);
  }
};

TEST(RadiusSearch, EvenPointsAreAllSeen) {
  SCOPED_TRACE(test_seed());
  for (const int n : {1, 300, 3000}) {
    Scan scan;
    scan.add(n, 12, 8);
    const double spacing = std::sqrt(std::max(96.0, 1.0) / n);
    const double radius = std::min(1.0, spacing * std::sqrt(30 / std::numbers::pi));
    const RadiusSearch search(scan.points, scan.cloud, 1);
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < search.size(); ++k) {
      std::set<std::size_t> found;
      search.in_radius(k, [&](std::size_t other) { found.insert(other); });
      EXPECT_TRUE(found.contains(k));
      // The box of the points is a little smaller than the one they are in, and so is the radius.
      for (std::size_t other = 0; other < search.size(); ++other) {
        const double d = scan.distance(k, other);
        if (d <= 0.9 * radius ? !found.contains(other) : d > radius && found.contains(other))
          ++wrong;
      }
    }
    EXPECT_EQ(wrong, 0U) << n;
  }
}

/// A facade as a vehicle scans it, and a roof as an aeroplane does.
TEST(RadiusSearch, PointsThatCrowdDoNotMakeThemQuadratic) {
  Scan scan;
  scan.add(1000, 20, 20);
  scan.add(30000, 20, 0.05);
  scan.add(20000, 0, 0);
  const RadiusSearch search(scan.points, scan.cloud, 1);
  for (std::size_t k = 0; k < search.size(); ++k) {
    std::size_t seen = 0, itself = 0;
    search.in_radius(k, [&](std::size_t other) {
      ++seen;
      itself += other == k ? 1 : 0;
    });
    ASSERT_LE(seen, 9 * RadiusSearch::kMostInCell + 1);
    ASSERT_EQ(itself, 1U);
  }
}

}  // namespace
}  // namespace tetropolis
