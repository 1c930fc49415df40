#include <algorithm>

#include <gtest/gtest.h>

#include "tetropolis/check/check_mesh.h"

#include "support/small_city.h"

namespace tetropolis {
namespace {

CityModel model_of(const std::vector<Polygon>& footprints) {
  CityModel city;
  city.domain = {0, 0, 100, 100};
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    Building building;
    building.id = "b" + std::to_string(b);
    building.source_ids = {"s" + std::to_string(b)};
    building.footprint = footprints[b];
    building.h_roof = 10;
    city.buildings.push_back(building);
  }
  return city;
}

std::string first_violation(const CityModel& city, std::optional<double> distance = 1.0) {
  const CityCheck check = check_city(city, distance);
  return check.violations.empty() ? "" : check.violations[0].what;
}

using testing::rectangle;

TEST(CheckCity, MeasuresClearanceBetweenAndWithinRings) {
  const CityCheck apart =
      check_city(model_of({rectangle(10, 10, 20, 20), rectangle(21.5, 10, 30, 20)}), 1.0);
  EXPECT_TRUE(apart.violations.empty());
  EXPECT_DOUBLE_EQ(apart.min_clearance, 1.5);
  EXPECT_DOUBLE_EQ(apart.area, 185);
  EXPECT_EQ(first_violation(model_of({rectangle(10, 10, 20, 20), rectangle(20.5, 10, 30, 20)})),
            "clearance below the threshold");
  // A corner that comes close to the middle of a wall; a needle; a courtyard near the outline.
  EXPECT_EQ(
      first_violation(model_of({rectangle(10, 10, 20, 20), {{{20.9, 15}, {30, 5}, {30, 25}}, {}}})),
      "clearance below the threshold");
  EXPECT_EQ(first_violation(model_of({{{{10, 10}, {40, 10}, {40, 10.5}}, {}}})),
            "clearance below the threshold");
  EXPECT_EQ(first_violation(model_of(
                {{{{10, 10}, {40, 10}, {40, 40}, {10, 40}}, {{{20, 20}, {20, 39.5}, {30, 30}}}}})),
            "clearance below the threshold");
}

TEST(CheckCity, SeesBrokenRings) {
  EXPECT_EQ(first_violation(model_of({{{{10, 10}, {10, 20}, {20, 20}, {20, 10}}, {}}})),
            "outer rings not counter-clockwise");
  EXPECT_EQ(first_violation(model_of(
                {{{{10, 10}, {40, 10}, {40, 40}, {10, 40}}, {{{20, 20}, {30, 20}, {30, 30}}}}})),
            "holes not clockwise");
  EXPECT_EQ(first_violation(model_of({{{{10, 10}, {20, 10}}, {}}})),
            "footprints with fewer than 3 vertices");
  const CityCheck crossing =
      check_city(model_of({rectangle(10, 10, 30, 30), rectangle(20, 20, 40, 40)}), 1.0);
  EXPECT_TRUE(std::any_of(crossing.violations.begin(), crossing.violations.end(),
                          [](const Violation& v) { return v.what == "rings that cross"; }));
}

TEST(CheckCity, SeesSharedCornersAndTheDomainsBoundary) {
  EXPECT_EQ(check_city(model_of({rectangle(10, 10, 20, 20), rectangle(20, 20, 30, 30)}), 1.0)
                .min_clearance,
            0);
  EXPECT_EQ(first_violation(model_of({rectangle(0.5, 10, 20, 20)})),
            "footprints too close to the domain's boundary");
}

TEST(CheckCity, RawModelsMayTouchAndOverlap) {
  EXPECT_EQ(first_violation(model_of({rectangle(10, 10, 30, 30), rectangle(20, 20, 40, 40),
                                      rectangle(40, 20, 50, 40)}),
                            std::nullopt),
            "");
}

TEST(CheckCity, SeesHeightsAndAccounts) {
  CityModel city = model_of({rectangle(10, 10, 20, 20), rectangle(30, 10, 40, 20)});
  city.buildings[1].h_roof = city.buildings[1].h_ground;
  EXPECT_EQ(first_violation(city), "roofs not above the ground");
  city = model_of({rectangle(10, 10, 20, 20), rectangle(30, 10, 40, 20)});
  city.dropped.push_back({"s1", "too small"});
  EXPECT_EQ(first_violation(city), "input features accounted for more than once");
  city.dropped.clear();
  city.buildings[0].source_ids.clear();
  EXPECT_EQ(first_violation(city), "buildings without source");
}

}  // namespace
}  // namespace tetropolis
