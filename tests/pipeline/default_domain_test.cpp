#include "pipeline/default_domain.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

namespace tetropolis {
namespace {

constexpr Point2 kOrigin{84000, 447000};
constexpr Bounds2 kPoints{0, 0, 200, 100};  // local

/// The domain of houses (local boxes) under points in kPoints, local frame.
Bounds2 domain_of(const std::vector<Bounds2>& houses, const BuildCityOptions& options = {}) {
  FootprintsInput input;
  for (const Bounds2& house : houses) {
    const Bounds2 box = house.moved(kOrigin);
    input.features.push_back({"", rectangle(box)});
    input.bounds.extend(box);
  }
  return default_domain(options, input, kPoints, kOrigin);
}

void expect_box(const Bounds2& found, const Bounds2& expected) {
  EXPECT_NEAR(found.xmin, expected.xmin, 1e-9);
  EXPECT_NEAR(found.ymin, expected.ymin, 1e-9);
  EXPECT_NEAR(found.xmax, expected.xmax, 1e-9);
  EXPECT_NEAR(found.ymax, expected.ymax, 1e-9);
}

const Bounds2 kMiddle{90, 48, 100, 52};

TEST(DefaultDomain, IsTheMarginAroundFootprintsAsFarAsThereArePoints) {
  expect_box(domain_of({kMiddle}), {50, 8, 140, 92});
  expect_box(domain_of({kMiddle}, {.domain_margin = 70}), {20, 0, 170, 100});
  // Near the end of the points, but no nearer than walls keep from the boundary.
  expect_box(domain_of({kMiddle, {185, 40, 197, 50}}), {50, 0, 200, 92});
}

TEST(DefaultDomain, ReachesBeyondThePointsForBuildingsMostlyWithinThem) {
  const Bounds2 mostly_in{180, 40, 215, 60};
  expect_box(domain_of({kMiddle, mostly_in}), {50, 0, 225, 100});
  // So near to the end of the points that the boundary would cut it back.
  expect_box(domain_of({kMiddle, {180, 40, 199.5, 60}}), {50, 0, 209.5, 100});
  // Not for those that are mostly elsewhere, and not further than the margin.
  const Bounds2 mostly_out{195, 40, 206, 60}, far{100, 40, 241, 60};
  expect_box(domain_of({kMiddle, mostly_out}), {50, 0, 200, 100});
  expect_box(domain_of({kMiddle, far}), {50, 0, 200, 100});
  expect_box(domain_of({kMiddle, mostly_in}, {.domain_margin = 14}), {76, 26, 200, 74});
  expect_box(domain_of({kMiddle, mostly_in}, {.domain_margin = 0}), {90, 40, 200, 60});
  // On all sides at once.
  expect_box(domain_of({{-2, -3, 204, 105}}), {-12, -13, 214, 115});
  // Clipped buildings need no more than there are points.
  expect_box(domain_of({kMiddle, mostly_in}, {.boundary_buildings = BoundaryBuildings::kClip}),
             {50, 0, 200, 100});
}

TEST(DefaultDomain, GoesByAreaNotByBoxes) {
  // A wedge with its broad end within the points: half of its length is outside, a quarter of it.
  FootprintsInput input;
  input.features.push_back({"", {{{84180, 447040}, {84220, 447050}, {84180, 447060}}, {}}});
  input.bounds = bounds(input.features[0].polygon);
  expect_box(default_domain({}, input, kPoints, kOrigin), {140, 0, 230, 100});
  // The other way round.
  input.features[0].polygon = {{{84180, 447050}, {84220, 447040}, {84220, 447060}}, {}};
  expect_box(default_domain({}, input, kPoints, kOrigin), {140, 0, 200, 100});
}

}  // namespace
}  // namespace tetropolis
