#include "tetropolis/terrain/dtm.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

PointCloud random_cloud(int points, const Bounds2& box) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> share(0, 1);
  PointCloud cloud;
  for (int k = 0; k < points; ++k)
    cloud.push_back(box.xmin + share(random) * box.width(), box.ymin + share(random) * box.height(),
                    100 * share(random), static_cast<std::uint8_t>(random() % 12));
  return cloud;
}

Raster random_raster_with_voids(std::int32_t nx, std::int32_t ny, double share_empty) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> share(0, 1);
  Raster raster{nx, ny, 0, 0, 1, {}};
  for (std::int32_t k = 0; k < nx * ny; ++k)
    raster.values.push_back(share(random) < share_empty ? kNaN : 50 * share(random));
  return raster;
}

/// The definition, word for word: sweep the whole raster once per front.
void fill_by_sweeps(Raster& raster) {
  for (bool changed = true; changed;) {
    changed = false;
    const Raster before = raster;
    for (std::int32_t j = 0; j < raster.ny; ++j)
      for (std::int32_t i = 0; i < raster.nx; ++i) {
        if (!std::isnan(before.at(i, j))) continue;
        double sum = 0;
        int count = 0;
        for (std::int32_t nj = j - 1; nj <= j + 1; ++nj)
          for (std::int32_t ni = i - 1; ni <= i + 1; ++ni) {
            if (ni < 0 || nj < 0 || ni >= raster.nx || nj >= raster.ny) continue;
            if (std::isnan(before.at(ni, nj))) continue;
            sum += before.at(ni, nj);
            ++count;
          }
        if (count == 0) continue;
        raster.values[static_cast<std::size_t>(j * raster.nx + i)] = sum / count;
        changed = true;
      }
  }
}

TEST(DtmGrid, CoversTheDomainWithNoNodeToSpare) {
  EXPECT_EQ(dtm_grid({0, 0, 100, 50}, 1).nx, 101);
  EXPECT_EQ(dtm_grid({0, 0, 100, 50}, 1).ny, 51);
  EXPECT_EQ(dtm_grid({0, 0, 100.5, 50}, 1).nx, 102);
  // 0.1 * 3 / 0.1 is slightly more than 3 in doubles.
  EXPECT_EQ(dtm_grid({0, 0, 0.1 * 3, 1}, 0.1).nx, 4);
  EXPECT_EQ(dtm_grid({0, 0, 0.7, 1}, 0.1).nx, 8);
  EXPECT_EQ(dtm_grid({5, 5, 5, 5}, 1).values.size(), 1U);
  const Raster raster = dtm_grid({-3.5, 2.25, 96.1, 40}, 0.7);
  EXPECT_EQ(raster.x0, -3.5);
  EXPECT_EQ(raster.y0, 2.25);
  EXPECT_GE(raster.bounds().xmax, 96.1);
  EXPECT_LT(raster.bounds().xmax, 96.1 + 0.7);
}

TEST(DtmGrid, RefusesNonsense) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(dtm_grid({0, 0, 10, 10}, 0), Error);
  EXPECT_THROW(dtm_grid({0, 0, 10, 10}, -1), Error);
  EXPECT_THROW(dtm_grid({0, 0, 10, 10}, kNaN), Error);
  EXPECT_THROW(dtm_grid({10, 0, 0, 10}, 1), Error);
  EXPECT_THROW(dtm_grid({0, 0, inf, 10}, 1), Error);
  EXPECT_THROW(dtm_grid({0, 0, 1e6, 1e6}, 0.5), Error);
}

TEST(DtmGrid, HasNodesWholeStepsFromTheAnchor) {
  const Raster raster = dtm_grid({3, 7, 9, 8}, 2, Point2{100.5, -0.5});
  EXPECT_EQ(raster.bounds(), (Bounds2{2.5, 5.5, 10.5, 9.5}));
  // Nodes at the corners, but for rounding: no node to spare.
  const Raster even = dtm_grid({0.3, 0, 0.7, 1}, 0.1, Point2{-0.6, 0});
  EXPECT_EQ(even.nx, 5);
  EXPECT_NEAR(even.x0, 0.3, 1e-15);
  EXPECT_THROW(dtm_grid({0, 0, 10, 10}, 1, Point2{kNaN, 0}), Error);
}

/// As dtm.h has it: heights depend on what is within as many steps as the next point is away.
TEST(BuildDtm, OverlappingDomainsWithOneAnchorAgreeAwayFromTheirRims) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> share(0, 1);
  std::size_t compared = 0, filled = 0;
  for (int round = 0; round < 50; ++round) {
    const double step = 0.3 + share(random);
    const Point2 anchor{1000 * share(random) - 500, 1000 * share(random) - 500};
    const Bounds2 whole{-60, -40, 90, 70};
    PointCloud cloud = random_cloud(4000, whole);
    for (std::size_t p = 0; p < cloud.size(); ++p) {  // a pond without points
      const double dx = cloud.x[p] - 12, dy = cloud.y[p] - 17;
      cloud.classification[p] = dx * dx + dy * dy < 64 ? kBuildingClass : kGround;
    }
    const auto domain = [&] {
      return Bounds2{whole.xmin + 50 * share(random), whole.ymin + 40 * share(random),
                     whole.xmax - 50 * share(random), whole.ymax - 40 * share(random)};
    };
    const auto node_of = [&](double x, double from) {
      return static_cast<std::int64_t>(std::floor((x - from) / step + 0.5));
    };
    struct Grid {
      Raster dtm;
      std::int64_t i0, j0;  ///< Of its first node, from the anchor.
    };
    const auto build = [&](const Bounds2& box) {
      DtmOptions options;
      options.step = step;
      options.anchor = anchor;
      Raster dtm = build_dtm(cloud, box, options);
      return Grid{dtm, node_of(dtm.x0, anchor.x), node_of(dtm.y0, anchor.y)};
    };
    const Grid a = build(domain()), b = build(domain());
    std::vector<std::pair<std::int64_t, std::int64_t>> with_points;
    for (std::size_t p = 0; p < cloud.size(); ++p)
      if (is_ground(cloud.classification[p]))
        with_points.emplace_back(node_of(cloud.x[p], anchor.x), node_of(cloud.y[p], anchor.y));
    const auto depth_in = [](const Grid& grid, std::int64_t i, std::int64_t j) {
      return std::min(
          {i - grid.i0, j - grid.j0, grid.i0 + grid.dtm.nx - 1 - i, grid.j0 + grid.dtm.ny - 1 - j});
    };
    const auto height = [](const Grid& grid, std::int64_t i, std::int64_t j) {
      return grid.dtm.at(static_cast<std::int32_t>(i - grid.i0),
                         static_cast<std::int32_t>(j - grid.j0));
    };
    for (std::int64_t k = 0; k < 400; ++k) {
      const std::int64_t i = a.i0 + static_cast<std::int64_t>(share(random) * a.dtm.nx);
      const std::int64_t j = a.j0 + static_cast<std::int64_t>(share(random) * a.dtm.ny);
      std::int64_t away = std::numeric_limits<std::int64_t>::max();
      for (const auto& [pi, pj] : with_points)
        away = std::min(away, std::max(std::abs(pi - i), std::abs(pj - j)));
      if (std::min(depth_in(a, i, j), depth_in(b, i, j)) < away) continue;
      ++compared;
      filled += away > 0 ? 1 : 0;
      ASSERT_EQ(height(a, i, j), height(b, i, j)) << round << " seed " << test_seed();
    }
  }
  EXPECT_GT(compared, 1000u);
  EXPECT_GT(filled, 500u);
}

TEST(BuildDtm, NodesHaveTheMeanOfTheirNearestGroundPoints) {
  const Bounds2 domain{-4, 3, 20, 21.5};
  const PointCloud cloud = random_cloud(5000, domain.grown(3));
  // No multiple of the resolution of points, so that none is as near to one node as to another.
  const DtmOptions options{1.4998777, {2, 9, 11}};
  DtmReport report;
  const Raster dtm = build_dtm(cloud, domain, options, {}, &report);
  std::int64_t used = 0;
  std::int64_t empty = 0;
  for (std::int32_t j = 0; j < dtm.ny; ++j)
    for (std::int32_t i = 0; i < dtm.nx; ++i) {
      double sum = 0;
      int count = 0;
      for (std::size_t p = 0; p < cloud.size(); ++p) {
        const int code = cloud.classification[p];
        if (code != 2 && code != 9 && code != 11) continue;
        const double dx = std::abs(cloud.x[p] - (dtm.x0 + i * dtm.step));
        const double dy = std::abs(cloud.y[p] - (dtm.y0 + j * dtm.step));
        if (dx >= dtm.step / 2 || dy >= dtm.step / 2) continue;
        sum += cloud.z[p];
        ++count;
      }
      used += count;
      empty += count == 0 ? 1 : 0;
      if (count > 0) {
        EXPECT_NEAR(dtm.at(i, j), sum / count, 1e-9) << i << " " << j << " seed " << test_seed();
      }
      EXPECT_TRUE(std::isfinite(dtm.at(i, j)));
    }
  EXPECT_EQ(report.ground_points, used);
  EXPECT_EQ(report.nodes, static_cast<std::int64_t>(dtm.values.size()));
  EXPECT_DOUBLE_EQ(report.empty_share,
                   static_cast<double>(empty) / static_cast<double>(dtm.values.size()));
}

TEST(BuildDtm, OneGroundPointFillsTheDomain) {
  PointCloud cloud;
  cloud.push_back(31, 17, 12.5, kGround);
  cloud.push_back(5, 5, 99, kBuildingClass);
  DtmReport report;
  const Raster dtm = build_dtm(cloud, {0, 0, 40, 30}, {}, {}, &report);
  for (const double z : dtm.values) EXPECT_EQ(z, 12.5);
  EXPECT_EQ(report.ground_points, 1);
  EXPECT_DOUBLE_EQ(report.empty_share, 1 - 1.0 / (41 * 31));
}

TEST(BuildDtm, VoidsAreSquaresWithoutAnyPoint) {
  PointCloud cloud;  // one point in each square of 20 m of the left half
  for (double y = 10; y < 100; y += 20)
    for (double x = 10; x < 50; x += 20) {
      cloud.push_back(x, y, 1, kGround);
    }
  DtmReport report;
  // Domains of whole squares have a row of nodes on their far side, which is no row of squares.
  for (const Bounds2& domain : {Bounds2{0, 0, 80, 100}, Bounds2{0, 0, 79, 99}}) {
    build_dtm(cloud, domain, {}, {}, &report);
    EXPECT_EQ(report.voids, 10);
    EXPECT_EQ(report.void_share, 0.5);
    EXPECT_GT(report.empty_share, 0.99);
  }
}

TEST(BuildDtm, PointsOutsideTheGridAreIgnored) {
  PointCloud cloud;
  cloud.push_back(5, 5, 1, kGround);
  cloud.push_back(-0.5, 0, 2, kGround);  // Half a step outside still rounds to node 0.
  cloud.push_back(-0.51, 0, 1000, kGround);
  cloud.push_back(10.5, 0, 1000, kGround);  // Rounds up, to a node beyond the last.
  cloud.push_back(0, 1e300, 1000, kGround);
  DtmReport report;
  const Raster dtm = build_dtm(cloud, {0, 0, 10, 10}, {}, {}, &report);
  EXPECT_EQ(report.ground_points, 2);
  EXPECT_EQ(dtm.at(0, 0), 2);
  EXPECT_LE(*std::max_element(dtm.values.begin(), dtm.values.end()), 2);
}

TEST(BuildDtm, WithoutGroundPointsSaysWhichClassesThereAre) {
  PointCloud cloud;
  cloud.push_back(5, 5, 1, 1);
  cloud.push_back(5, 6, 1, 6);
  cloud.push_back(5, 7, 1, 6);
  cloud.push_back(500, 500, 1, kGround);  // Ground, but not here.
  const std::string message = testing::error_of(
      [&] {
        build_dtm(cloud, {0, 0, 10, 10});
      },
      ErrorKind::kInput);
  EXPECT_NE(message.find("class 2, 9"), std::string::npos) << message;
  EXPECT_NE(message.find("class 6 (2 points)"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_THROW(build_dtm({}, {0, 0, 10, 10}), Error);
}

TEST(BuildDtm, ReportsProgressAndStops) {
  PointCloud cloud;
  cloud.push_back(5, 5, 1, kGround);
  double last = -1;
  build_dtm(cloud, {0, 0, 50, 50}, {},
            {[&](double fraction) {
               EXPECT_GE(fraction, last);
               last = fraction;
             },
             {}});
  EXPECT_EQ(last, 1);
  EXPECT_THROW(build_dtm(cloud, {0, 0, 50, 50}, {}, {{}, [] { return true; }}), Cancelled);
}

TEST(FillEmptyNodes, AgreesWithSweeps) {
  for (const double share_empty : {0.1, 0.6, 0.95, 0.995}) {
    Raster filled = random_raster_with_voids(61, 47, share_empty);
    Raster expected = filled;
    fill_empty_nodes(filled);
    fill_by_sweeps(expected);
    for (std::size_t k = 0; k < filled.values.size(); ++k)
      ASSERT_NEAR(filled.values[k], expected.values[k], 1e-10)
          << "node " << k << " share " << share_empty << " seed " << test_seed();
  }
}

TEST(FillEmptyNodes, DoesNotDependOnTheDirection) {
  const Raster original = random_raster_with_voids(53, 53, 0.97);
  const std::int32_t n = original.nx;
  Raster plain = original;
  fill_empty_nodes(plain);
  const auto check = [&](const char* name, const auto& image) {
    Raster turned = original;
    for (std::int32_t j = 0; j < n; ++j)
      for (std::int32_t i = 0; i < n; ++i)
        turned.values[static_cast<std::size_t>(image(i, j))] = original.at(i, j);
    fill_empty_nodes(turned);
    for (std::int32_t j = 0; j < n; ++j)
      for (std::int32_t i = 0; i < n; ++i)
        ASSERT_EQ(turned.values[static_cast<std::size_t>(image(i, j))], plain.at(i, j))
            << name << " seed " << test_seed();
  };
  check("mirrored", [&](std::int32_t i, std::int32_t j) { return j * n + (n - 1 - i); });
  check("upside down", [&](std::int32_t i, std::int32_t j) { return (n - 1 - j) * n + i; });
  check("transposed", [&](std::int32_t i, std::int32_t j) { return i * n + j; });
  check("half a turn",
        [&](std::int32_t i, std::int32_t j) { return (n - 1 - j) * n + (n - 1 - i); });
}

TEST(FillEmptyNodes, LeavesFullRastersAlone) {
  Raster raster = random_raster_with_voids(10, 7, 0);
  const std::vector<double> before = raster.values;
  fill_empty_nodes(raster);
  EXPECT_EQ(raster.values, before);
}

}  // namespace
}  // namespace tetropolis
