// Roofs of several parts, in the city model and in the mesh: sound ones pass, and each way to break
// them is seen.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/check/check_city.h"

#include "check/check_ground.h"
#include "check/check_heights.h"
#include "support/roofs.h"
#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

std::string first_of(const std::vector<Violation>& violations) {
  return violations.empty() ? "" : violations[0].what;
}

CityModel bricks(std::mt19937& random) {
  CityModel city;
  city.domain = {0, 0, 200, 200};
  for (std::size_t i = 0; i < 4; ++i) {
    Building building = testing::brick_building(
        random, 3, 3 + i % 2,
        {50 + 90.0 * static_cast<double>(i % 2), 40 + 80.0 * static_cast<double>(i / 2)},
        0.2 * static_cast<double>(i));
    building.id = "b" + std::to_string(i);
    building.source_ids = {"s" + std::to_string(i)};
    city.buildings.push_back(std::move(building));
  }
  return city;
}

TEST(CheckCityParts, SoundPartsPassAndOthersDoNot) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  const CityModel sound = bricks(random);
  const CityCheck check = check_city(sound, 0.3);
  EXPECT_EQ(first_of(check.violations), "");
  std::size_t parts = 0;
  for (const Building& building : sound.buildings) parts += building.parts.size();
  EXPECT_EQ(check.parts, static_cast<std::int64_t>(parts));
  EXPECT_LT(check.part_clearance, 2);
  EXPECT_EQ(first_of(check_city(sound, check.part_clearance).violations), "");
  EXPECT_EQ(first_of(check_city(sound, check.part_clearance + 1e-6).violations),
            "lines of parts closer than the threshold");
  const auto violation = [&](const auto& edit) {
    CityModel city = sound;
    edit(city.buildings[1].parts);
    return first_of(check_city(city, 0.3).violations);
  };
  using Parts = std::vector<RoofPart>;
  const char* const kTile = "parts that do not tile their footprint";
  EXPECT_EQ(violation([](Parts& parts_of) { parts_of.pop_back(); }), kTile);
  EXPECT_EQ(violation([](Parts& parts_of) { parts_of.push_back(parts_of.front()); }), kTile);
  EXPECT_EQ(violation([](Parts& parts_of) { parts_of[2].outline.outer[1].x += 1e-4; }), kTile);
  EXPECT_EQ(violation([](Parts& parts_of) {
              std::reverse(parts_of[2].outline.outer.begin(), parts_of[2].outline.outer.end());
            }),
            "parts that are no counter-clockwise polygons");
  EXPECT_EQ(violation([](Parts& parts_of) { parts_of[2].roof.slope_x = std::nan(""); }),
            "roof planes that are not finite");
  EXPECT_EQ(violation([](Parts& parts_of) { parts_of[2].roof.elevation -= 30; }),
            "roofs not above the ground");
}

/// A house of 8 m x 6 m with a ridge along x = 4, and a flat annexe to the east, 10 cm below the
/// eaves; its roofs as they look from below.
class CheckRoofs : public ::testing::Test {
 protected:
  void SetUp() override {
    Building& building = model.buildings.emplace_back();
    building.id = "b1";
    building.footprint.outer = {{0, 0}, {4, 0}, {8, 0}, {12, 0}, {12, 6}, {8, 6}, {4, 6}, {0, 6}};
    building.h_ground = 0;
    building.h_roof = 5;
    const auto add = [&](const Ring& outline, const RoofPlane& roof) {
      RoofPart& part = building.parts.emplace_back();
      part.outline.outer = outline;
      part.roof = roof;
    };
    add({{0, 0}, {4, 0}, {4, 6}, {0, 6}}, {{0, 0}, 5, 0.5, 0});
    add({{4, 0}, {8, 0}, {8, 6}, {4, 6}}, {{4, 0}, 7, -0.5, 0});
    add({{8, 0}, {12, 0}, {12, 6}, {8, 6}}, {{8, 0}, 4.9, 0, 0});
    for (std::size_t k = 0; k < building.parts.size(); ++k) add_roof(building.parts[k]);
  }

  void add_roof(const RoofPart& part) {
    const Ring& ring = part.outline.outer;
    std::array<std::int32_t, 4> corner{};
    for (std::size_t i = 0; i < 4; ++i) corner[i] = vertex(ring[i], part.roof(ring[i]));
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, std::array{0, 3, 2}}) {
      surface.triangles.push_back({corner[static_cast<std::size_t>(a)],
                                   corner[static_cast<std::size_t>(b)],
                                   corner[static_cast<std::size_t>(c)]});
      surface.patch.push_back(Patch::kRoof);
      surface.building.push_back(BuildingIndex(0));
    }
  }

  std::int32_t vertex(Point2 p, double z) {
    const std::array<double, 3> wanted{p.x, p.y, z};
    const auto it = std::find(surface.points.begin(), surface.points.end(), wanted);
    if (it == surface.points.end()) {
      surface.points.push_back(wanted);
      return static_cast<std::int32_t>(surface.points.size()) - 1;
    }
    return static_cast<std::int32_t>(it - surface.points.begin());
  }

  std::array<double, 3>& at(double x, double y, double z) {
    for (auto& p : surface.points)
      if (p[0] == x && p[1] == y && std::abs(p[2] - z) < 1e-6) return p;
    ADD_FAILURE() << "no such vertex";
    return surface.points[0];
  }

  HeightsCheck heights() const {
    return check_heights(surface, {0, 0, 0}, dtm, model, 1, ExcavationSources{});
  }

  CityModel model;
  SurfaceMesh surface;
  Raster dtm = testing::raster_of({0, 0, 20, 20}, [](double, double) { return 0.0; });
};

TEST_F(CheckRoofs, VerticesAreOnTheirPartsPlanes) {
  EXPECT_EQ(first_of(heights().violations), "");
  EXPECT_EQ(heights().roof_snapped, 0);
  EXPECT_EQ(heights().roof_vertices, 10);
  const char* const kOff = "roof vertices off the roof height";
  // A corner that no other part has; the ridge, where two planes are the same.
  for (const auto& [x, z] : {std::pair{0.0, 5.0}, std::pair{4.0, 7.0}, std::pair{12.0, 4.9}})
    for (const double off : {-1e-6, 1e-6}) {
      auto& p = at(x, 0, z);
      p[2] += off;
      EXPECT_EQ(first_of(heights().violations), kOff) << x;
      p[2] = z;
    }
  // The eaves may meet the annexe, and no more.
  for (const double z : {4.9, 4.95, 5.0}) {
    for (const double own : {5.0, 4.9}) {
      auto& p = at(8, 6, own);
      p[2] = z;
      EXPECT_EQ(first_of(heights().violations), "");
      EXPECT_EQ(heights().roof_snapped, std::abs(z - own) < 0.01 ? 0 : 1);
      EXPECT_NEAR(heights().most_snapped, std::abs(z - own), 1e-9);
      p[2] = own;
    }
  }
  for (const double z : {4.9 - 1e-6, 5 + 1e-6}) {
    auto& p = at(8, 6, 5);
    p[2] = z;
    EXPECT_EQ(first_of(heights().violations), kOff);
    p[2] = 5;
  }
  // As far from the origin as the reference system may be.
  model.origin = {84800, 4447400};
  EXPECT_EQ(first_of(heights().violations), "");
  for (BuildingIndex& building : surface.building) building = BuildingIndex(7);
  EXPECT_EQ(first_of(heights().violations), "roofs of buildings that the city model lacks");
}

TEST_F(CheckRoofs, LinesOfPartsAreEdges) {
  EXPECT_EQ(first_of(check_ground(surface, {0, 0, 0}, model, 0).violations), "");
  // The line between house and annexe left out: two faces that each are over both.
  Building& building = model.buildings[0];
  surface = {};
  RoofPart whole = building.parts[1];
  whole.outline.outer = {{4, 0}, {12, 0}, {12, 6}, {4, 6}};
  add_roof(building.parts[0]);
  add_roof(whole);
  std::vector<std::string> found;
  for (const Violation& violation : check_ground(surface, {0, 0, 0}, model, 0).violations)
    found.push_back(violation.what);
  EXPECT_NE(std::find(found.begin(), found.end(), "footprint vertices off the roof's outline"),
            found.end());
  EXPECT_NE(std::find(found.begin(), found.end(), "roof outlines that leave the footprint's edges"),
            found.end());
  // A part without faces.
  surface = {};
  add_roof(building.parts[0]);
  add_roof(building.parts[1]);
  EXPECT_EQ(first_of(check_ground(surface, {0, 0, 0}, model, 0).violations),
            "buildings without roof faces");
}

}  // namespace
}  // namespace tetropolis
