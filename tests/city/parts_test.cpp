#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/raise_roofs.h"
#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"

#include "city/part_lines.h"
#include "city/part_tiling.h"
#include "support/roofs.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

Building random_building(std::mt19937& random, std::size_t i) {
  return testing::brick_building(random, 3 + i % 3, 3 + i % 2, {10, 20},
                                 0.7 * static_cast<double>(i));
}

TEST(PartTiling, BricksTileAndWhatIsMovedDoesNot) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  for (std::size_t i = 0; i < 30; ++i) {
    const Building building = random_building(random, i);
    EXPECT_EQ(tiling_fault(building.footprint, building.parts), "");
    const std::size_t one = random() % building.parts.size();
    const auto fault = [&](const auto& edit) {
      Building edited = building;
      edit(edited, edited.parts[one].outline);
      return tiling_fault(edited.footprint, edited.parts);
    };
    EXPECT_NE(fault([](Building&, Polygon& outline) { outline.outer[1].x += kCoordinateStep; }),
              "");
    EXPECT_NE(fault([](Building&, Polygon& outline) { outline.outer.pop_back(); }), "");
    EXPECT_NE(fault([](Building&, Polygon& outline) {
                std::reverse(outline.outer.begin(), outline.outer.end());
              }),
              "");
    EXPECT_NE(fault([&](Building& edited, Polygon&) { edited.parts.push_back(edited.parts[one]); }),
              "");
    EXPECT_NE(fault([&](Building& edited, Polygon&) {
                edited.parts.erase(edited.parts.begin() + static_cast<std::ptrdiff_t>(one));
              }),
              "");
    EXPECT_NE(fault([](Building& edited, Polygon&) { edited.footprint.outer.pop_back(); }), "");
    EXPECT_NE(fault([](Building& edited, Polygon&) { edited.footprint.holes.clear(); }), "");
  }
}

TEST(LineClearance, IsThatOfAllPairs) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  for (std::size_t i = 0; i < 30; ++i) {
    const Building building = random_building(random, i);
    std::vector<Point2> corners;
    std::vector<std::pair<Point2, Point2>> edges;
    for (const RoofPart& part : building.parts)
      for_each_edge(part.outline, [&](Point2 a, Point2 b) {
        corners.push_back(a);
        edges.emplace_back(a, b);
      });
    double least = 1e9, sharpest = 1e9;
    for (const auto& [a, b] : edges)
      for (const Point2& p : corners)
        if (!(p == a) && !(p == b)) least = std::min(least, distance_to_segment(p, a, b));
    const auto is_outer = [&](Point2 a, Point2 b) {
      return std::find(edges.begin(), edges.end(), std::pair{b, a}) == edges.end();
    };
    for (const auto& [a, b] : edges)
      for (const auto& [c, d] : edges)
        for (const auto& [apex, p, q] :
             {std::tuple{a, b, c}, std::tuple{a, b, d}, std::tuple{b, a, c}, std::tuple{b, a, d}}) {
          const bool meet = apex == c || apex == d;
          const Point2 other = apex == c ? d : c;
          static_cast<void>(q);
          if (!meet || other == p || (is_outer(a, b) && is_outer(c, d))) continue;
          const double ux = p.x - apex.x, uy = p.y - apex.y;
          const double vx = other.x - apex.x, vy = other.y - apex.y;
          sharpest = std::min(
              sharpest,
              std::acos(std::clamp((ux * vx + uy * vy) / (std::hypot(ux, uy) * std::hypot(vx, vy)),
                                   -1.0, 1.0)));
        }
    const LineClearance clearance = line_clearance(building.parts);
    EXPECT_NEAR(clearance.distance, least, 1e-9);
    EXPECT_NEAR(clearance.angle, sharpest, 1e-6);
  }
}

TEST(RoofAngles, AreThoseOfACompass) {
  const auto azimuth = [](double x, double y) { return azimuth_degrees({{0, 0}, 0, x, y}); };
  EXPECT_EQ(azimuth(0, 0), std::nullopt);
  EXPECT_EQ(azimuth(0, -1), 0);   // looks north
  EXPECT_EQ(azimuth(-1, 0), 90);  // east
  EXPECT_EQ(azimuth(0, 1), 180);
  EXPECT_EQ(azimuth(1, 0), 270);
  EXPECT_EQ(azimuth(1, -1), 315);
  EXPECT_EQ(slope_degrees({{0, 0}, 0, 0.6, 0.8}), 45);
  EXPECT_EQ(slope_degrees({{0, 0}, 5, 0, 0}), 0);
}

TEST(RaiseRoofs, PartsFollowEditsOfTheHeight) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  CityModel city;
  for (std::size_t i = 0; i < 3; ++i) city.buildings.push_back(random_building(random, i));
  const CityModel before = city;
  std::vector<double> heights = roof_heights(city);
  city.buildings[1].h_roof += 10;
  city.buildings[2].h_roof = std::nan("");
  follow_roof_heights(city, heights);
  follow_roof_heights(city, heights);  // once is enough
  const auto risen = [&](std::size_t b, std::size_t k) {
    const RoofPlane &now = city.buildings[b].parts[k].roof,
                    &then = before.buildings[b].parts[k].roof;
    EXPECT_EQ(now.at, then.at);
    EXPECT_EQ(now.slope_x, then.slope_x);
    EXPECT_EQ(now.elevation, snap_height(now.elevation));
    return now.elevation - then.elevation;
  };
  for (std::size_t k = 0; k < before.buildings[1].parts.size(); ++k)
    EXPECT_NEAR(risen(1, k), 10, 1e-9);
  for (const std::size_t b : {0, 2})
    for (std::size_t k = 0; k < before.buildings[b].parts.size(); ++k) EXPECT_EQ(risen(b, k), 0);
  // A height that is none for a while.
  city.buildings[2].h_roof = before.buildings[2].h_roof + 0.5;
  follow_roof_heights(city, heights);
  EXPECT_NEAR(risen(2, 0), 0.5, 1e-9);
  // Lowered to a third, no part goes below the least height that building parts have.
  CityModel low = before;
  heights = roof_heights(low);
  for (Building& building : low.buildings)
    building.h_roof = building.h_ground + (building.h_roof - building.h_ground) / 3;
  follow_roof_heights(low, heights);
  for (std::size_t b = 0; b < low.buildings.size(); ++b) {
    const Building& building = low.buildings[b];
    for (std::size_t k = 0; k < building.parts.size(); ++k) {
      const double least = std::min(
          {building.h_ground + 2.5, building.h_roof, range_of(before.buildings[b].parts[k]).low});
      EXPECT_GE(range_of(building.parts[k]).low, least - 1e-3);
    }
  }
  raise_roof(city.buildings[0], 0.25);
  EXPECT_NEAR(risen(0, 0), 0.25, 1e-9);
  EXPECT_NEAR(city.buildings[0].h_roof, before.buildings[0].h_roof + 0.25, 1e-12);
}

TEST(RoofSummary, WeighsPartsByTheirPoints) {
  Building building;
  building.footprint = {{{0, 0}, {10, 0}, {10, 4}, {0, 4}}, {}};
  building.h_ground = 1;
  building.h_roof = 6;
  EXPECT_EQ(volume_of(building), 200);
  EXPECT_TRUE(std::isnan(rmse_of(building.parts)));
  EXPECT_EQ(highest_lod(building.parts), Lod::kBlock);
  RoofPart flat, shed;
  flat.outline.outer = {{0, 0}, {5, 0}, {5, 4}, {0, 4}};
  flat.roof.elevation = 3;
  flat.lod = Lod::k1_3;
  flat.n_points = 30;
  flat.rmse = 0.1;
  shed.outline.outer = {{5, 0}, {10, 0}, {10, 4}, {5, 4}};
  shed.roof = {{5, 0}, 4, 0.2, 0};
  shed.lod = Lod::k2_2;
  shed.n_points = 10;
  shed.rmse = 0.5;
  building.parts = {flat, shed};
  EXPECT_NEAR(volume_of(building), 20 * 2 + 20 * 3.5, 1e-12);
  EXPECT_NEAR(rmse_of(building.parts), std::sqrt((30 * 0.01 + 10 * 0.25) / 40), 1e-12);
  EXPECT_EQ(highest_lod(building.parts), Lod::k2_2);
  EXPECT_NEAR(range_of(building.parts[1]).low, 4, 1e-12);
  EXPECT_NEAR(range_of(building.parts[1]).high, 5, 1e-12);
  building.parts[1].n_points = 0;
  building.parts[1].rmse = std::nan("");
  EXPECT_NEAR(rmse_of(building.parts), 0.1, 1e-12);
}

}  // namespace
}  // namespace tetropolis
