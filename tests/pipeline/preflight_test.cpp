#include "tetropolis/pipeline/preflight.h"

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr Point2 kTilesOrigin{85000, 447000};

/// Points in local coordinates, footprints in those of the CRS.
PointsInput points_at(const std::vector<Point2>& positions) {
  PointsInput points;
  points.origin = kTilesOrigin;
  for (const Point2 p : positions) {
    points.points.push_back(p.x, p.y, 0, 2);
    points.extent.extend(p);
  }
  return points;
}

FootprintsInput footprints_at(const std::vector<Polygon>& polygons) {
  FootprintsInput input;
  for (Polygon polygon : polygons) {
    for (Point2& p : polygon.outer) p = {p.x + kTilesOrigin.x, p.y + kTilesOrigin.y};
    for (Ring& hole : polygon.holes)
      for (Point2& p : hole) p = {p.x + kTilesOrigin.x, p.y + kTilesOrigin.y};
    input.bounds.extend(bounds(polygon));
    input.features.push_back({"", std::move(polygon), 0});
  }
  return input;
}

/// Many points and buildings, some without any point: the same count as one by one.
TEST(Preflight, CountsFootprintsWithAPointInside) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> where(0, 400), size(0.2, 15);
  for (const int count : {5, 300, 200'000}) {
    SCOPED_TRACE(count);
    std::vector<Point2> positions;
    for (int i = 0; i < count; ++i) positions.push_back({where(random), where(random) / 2});
    std::vector<Polygon> polygons;
    for (int i = 0; i < 200; ++i) {
      const double x = where(random), y = where(random);
      const Bounds2 box{x, y, x + size(random), y + size(random)};
      polygons.push_back(rectangle(box));
      const Bounds2 yard = box.grown(-0.3);
      if (i % 3 == 0 && !yard.empty()) polygons.back().holes.push_back(rectangle(yard).outer);
    }
    const PointsInput points = points_at(positions);
    const auto with_points = std::count_if(polygons.begin(), polygons.end(), [&](const Polygon& p) {
      for (std::size_t i = 0; i < points.points.size(); ++i)
        if (contains(p, {points.points.x[i], points.points.y[i]})) return true;
      return false;
    });
    const Preflight found = preflight(points, footprints_at(polygons), std::nullopt);
    EXPECT_EQ(found.footprints, 200);
    EXPECT_EQ(found.footprints_with_points, with_points);
  }
}

TEST(Preflight, OverlapIsOfTheFootprintsWithinTheBounds) {
  const PointsInput points = points_at({{0, 0}, {100, 50}, {50, 20}, {20, 30}});
  const FootprintsInput footprints =
      footprints_at({rectangle({50, 0, 60, 10}), rectangle({190, 90, 250, 100})});
  const Preflight whole = preflight(points, footprints, std::nullopt);
  EXPECT_DOUBLE_EQ(whole.overlap, 50.0 * 50 / (200 * 100));
  EXPECT_DOUBLE_EQ(whole.points_per_m2, 4.0 / 5000);
  EXPECT_EQ(whole.footprints, 2);
  const Bounds2 bounds = Bounds2{0, 0, 100, 50}.moved(kTilesOrigin);
  const Preflight part = preflight(points, footprints, bounds);
  EXPECT_DOUBLE_EQ(part.overlap, 1);
  EXPECT_EQ(part.footprints, 1);
  const Preflight apart =
      preflight(points, footprints, Bounds2{180, 80, 300, 300}.moved(kTilesOrigin));
  EXPECT_EQ(apart.overlap, 0);
}

TEST(Preflight, BrokenCoordinatesAreNoBuildings) {
  const PointsInput points = points_at({{0, 0}, {100, 50}, {50, 20}});
  FootprintsInput footprints = footprints_at({rectangle({40, 10, 60, 30})});
  footprints.features.push_back(
      {"", {{{kTilesOrigin.x, kTilesOrigin.y}, {1e300, 0}, {0, 1e300}}, {}}, 0});
  footprints.features.push_back({"", {}, 0});
  const Preflight found = preflight(points, footprints, std::nullopt);
  EXPECT_EQ(found.footprints, 2);
  EXPECT_EQ(found.footprints_with_points, 1);
}

TEST(Preflight, OfNothingIsNothing) {
  EXPECT_EQ(preflight(points_at({}), footprints_at({}), std::nullopt).footprints, 0);
  const Preflight alone = preflight(points_at({{1, 1}}), footprints_at({}), std::nullopt);
  EXPECT_EQ(alone.points_per_m2, 0);
  EXPECT_EQ(alone.overlap, 0);
}

}  // namespace
}  // namespace tetropolis
