#include "pipeline/footprint_extent.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

namespace tetropolis {
namespace {

constexpr double kTolerance = 0.01;  // radians

Footprint footprint(Polygon polygon) { return {"", std::move(polygon), 0}; }

TEST(FootprintExtent, IsTheBoxOfWhatMakesABuilding) {
  const Bounds2 sound{100, 200, 160, 250};
  const std::vector<Footprint> good{footprint(rectangle({100, 210, 120, 220})),
                                    footprint(rectangle({130, 200, 160, 230})),
                                    footprint(rectangle({110, 240, 125, 250}))};
  const auto extent_with = [&](const Polygon& polygon) {
    std::vector<Footprint> features = good;
    features.insert(features.begin() + 1, footprint(polygon));
    return footprint_extent(features, kTolerance);
  };
  const auto expect = [](const Bounds2& box, const Bounds2& expected) {
    EXPECT_EQ(box.xmin, expected.xmin);
    EXPECT_EQ(box.ymin, expected.ymin);
    EXPECT_EQ(box.xmax, expected.xmax);
    EXPECT_EQ(box.ymax, expected.ymax);
  };
  expect(footprint_extent(good, kTolerance), sound);
  // No area; coordinates that are none; nothing at all.
  expect(extent_with({{{0, 0}, {50, 50}, {900, 900}}, {}}), sound);
  expect(extent_with({{{110, 210}, {1e300, 210}, {110, 230}}, {}}), sound);
  expect(extent_with({{{110, 210}, {2e9, 210}, {110, 230}}, {}}), sound);
  expect(extent_with({}), sound);
  // A spike without width goes, a wing does not.
  expect(extent_with({{{110, 210}, {900, 210}, {120, 210}, {120, 220}, {110, 220}}, {}}), sound);
  expect(extent_with({{{110, 210}, {900, 210}, {900, 215}, {120, 220}, {110, 220}}, {}}),
         {100, 200, 900, 250});
  // Two triangles that meet in a point have an area, though it adds up to none.
  expect(extent_with({{{0, 0}, {20, 20}, {20, 0}, {0, 20}}, {}}), {0, 0, 160, 250});
}

TEST(FootprintExtent, IsEmptyWhereNothingMakesABuilding) {
  EXPECT_TRUE(footprint_extent({}, kTolerance).empty());
  const std::vector<Footprint> none{footprint({{{0, 0}, {1, 1}, {2, 2}}, {}})};
  EXPECT_TRUE(footprint_extent(none, kTolerance).empty());
}

}  // namespace
}  // namespace tetropolis
