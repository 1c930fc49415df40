#include "tetropolis/pipeline/meshable.h"

#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/error.h"

#include "support/errors.h"
namespace tetropolis {
namespace {

/// A house of 8 m x 6 m below a gable, whose ridge meets the outline at (4, 0) and (4, 6).
CityModel gabled() {
  CityModel city;
  city.domain = {-50, -50, 50, 50};
  Building& building = city.buildings.emplace_back();
  building.id = "b1";
  building.source_ids = {"s1"};
  building.footprint.outer = {{0, 0}, {4, 0}, {8, 0}, {8, 6}, {4, 6}, {0, 6}};
  building.h_roof = 5;
  RoofPart& west = building.parts.emplace_back();
  west.outline.outer = {{0, 0}, {4, 0}, {4, 6}, {0, 6}};
  west.roof = {{0, 0}, 4, 0.5, 0};
  RoofPart& east = building.parts.emplace_back();
  east.outline.outer = {{4, 0}, {8, 0}, {8, 6}, {4, 6}};
  east.roof = {{8, 0}, 4, -0.5, 0};
  return city;
}

std::string error_of(const CityModel& city) {
  return testing::error_of([&] { require_meshable(city, 1, "a.json"); });
}

TEST(Meshable, PartsWithRoomStayAsTheyAre) {
  CityModel city = gabled();
  EXPECT_EQ(flatten_unmeshable(city, 1).count, 0U);
  EXPECT_EQ(city.buildings[0].parts.size(), 2U);
  EXPECT_EQ(error_of(city), "");
}

void move_ridge(Building& b, double south, double north) {
  for (Ring* ring : {&b.footprint.outer, &b.parts[0].outline.outer, &b.parts[1].outline.outer})
    for (Point2& p : *ring)
      if (p.x == 4) p.x = p.y == 0 ? south : north;
}

TEST(Meshable, LinesOfPartsMakeRoom) {
  const auto simplified = [](const auto& edit) {
    CityModel city = gabled();
    edit(city.buildings[0]);
    const FlattenedRoofs roofs = flatten_unmeshable(city, 1);
    EXPECT_EQ(roofs.count, 0U);
    EXPECT_EQ(roofs.simplified, 1U);
    EXPECT_EQ(error_of(city), "");
    return std::pair(city.buildings[0], roofs.first_simplified);
  };
  // A ridge that ends too near to a corner.
  const auto [moved, why] = simplified([](Building& b) { move_ridge(b, 0.75, 4); });
  EXPECT_EQ(why, "building b1 (feature s1): roof lines come as close as 0.7500 m (1 m required)");
  ASSERT_EQ(moved.parts.size(), 2U);
  CityModel before = gabled();
  move_ridge(before.buildings[0], 0.75, 4);
  const double volume = volume_of(before.buildings[0]);
  EXPECT_NEAR(volume_of(moved), volume, 0.02 * volume);
  for (const RoofPart& part : moved.parts) EXPECT_NEAR(std::abs(part.roof.slope_x), 0.5, 0.1);
  // A roof that is too steep.
  const auto [gentle, steep] = simplified([](Building& b) { b.parts[1].roof.slope_x = -3; });
  EXPECT_EQ(steep, "building b1 (feature s1): a roof has 71.6 degrees");
  ASSERT_EQ(gentle.parts.size(), 2U);
  // A chimney of a quarter of a square metre.
  const auto chimney = simplified([](Building& b) {
    const Ring square{{1.5, 2}, {2, 2}, {2, 2.5}, {1.5, 2.5}};
    RoofPart part = b.parts[0];
    part.outline.outer = square;
    part.roof = {{0, 0}, 8, 0, 0};
    b.parts[0].outline.holes.push_back({square.rbegin(), square.rend()});
    b.parts.push_back(part);
  });
  EXPECT_EQ(chimney.first.parts.size(), 2U);
}

TEST(Meshable, PartsWithoutRoomBecomeABlockWithoutTheirCorners) {
  CityModel city = gabled();
  Building& b = city.buildings[0];
  for (Ring* ring : {&b.footprint.outer, &b.parts[0].outline.outer, &b.parts[1].outline.outer})
    for (Point2& p : *ring) p = {p.x / 4, p.y / 4};  // three square metres
  const FlattenedRoofs flattened = flatten_unmeshable(city, 1.2);
  EXPECT_EQ(flattened.simplified, 0U);
  EXPECT_EQ(flattened.count, 1U);
  EXPECT_EQ(flattened.first,
            "building b1 (feature s1): roof lines come as close as 1.0000 m (1.2 m required)");
  EXPECT_TRUE(b.parts.empty());
  EXPECT_EQ(b.footprint.outer, (Ring{{0, 0}, {2, 0}, {2, 1.5}, {0, 1.5}}));
  EXPECT_EQ(error_of(city), "");
}

/// A valley that meets the wall at 12.5 degrees.
TEST(Meshable, LinesMeetAtAnAngle) {
  CityModel city;
  city.domain = {-50, -50, 50, 50};
  Building& building = city.buildings.emplace_back();
  building.footprint.outer = {{0, 0}, {20, 0}, {20, 4.434}, {20, 20}, {0, 20}};
  building.h_roof = 5;
  for (const Ring& ring :
       {Ring{{0, 0}, {20, 0}, {20, 4.434}}, Ring{{0, 0}, {20, 4.434}, {20, 20}, {0, 20}}}) {
    RoofPart& part = building.parts.emplace_back();
    part.outline.outer = ring;
    part.roof.elevation = 5;
  }
  EXPECT_EQ(flatten_unmeshable(city, 1).first_simplified,
            "building  (feature ?): roof lines meet at 12.5 degrees");
  // Corners of the outline may be as sharp as they like.
  EXPECT_GE(city.buildings[0].footprint.outer.size(), 4U);
}

TEST(Meshable, WrongPartsAreRefused) {
  CityModel city = gabled();
  city.buildings[0].parts.pop_back();
  EXPECT_NE(error_of(city).find("building b1 (feature s1): its parts "), std::string::npos);
  city = gabled();
  city.buildings[0].parts[0].roof.elevation = -3;
  EXPECT_NE(error_of(city).find("a roof goes down to -3.000 m, and h_ground is 0.000 m"),
            std::string::npos);
  city = gabled();
  for (Ring* ring : {&city.buildings[0].footprint.outer, &city.buildings[0].parts[0].outline.outer,
                     &city.buildings[0].parts[1].outline.outer})
    for (Point2& p : *ring)
      if (p.x == 4) p.x = 0.75;
  EXPECT_NE(error_of(city).find("its roof lines come as close as 0.7500 m (1 m required)"),
            std::string::npos);
}

}  // namespace
}  // namespace tetropolis
