#include "tetropolis/io/cityjson/city_surface.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/io/cityjson/cityjson.h"

#include "support/bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::TemporaryFolder;

/// Area of the faces of a patch; in the plan if `flat`.
double area_of(const SurfaceMesh& surface, Patch patch, bool flat) {
  double sum = 0;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (surface.patch[f] != patch) continue;
    std::array<Point3, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
      p[i] = surface.points[static_cast<std::size_t>(surface.triangles[f][i])];
    Point3 n{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
      n[c] = (p[1][d] - p[0][d]) * (p[2][e] - p[0][e]) - (p[1][e] - p[0][e]) * (p[2][d] - p[0][d]);
    }
    sum += (flat ? std::abs(n[2]) : std::hypot(n[0], n[1], n[2])) / 2;
  }
  return sum;
}

TEST(CitySurface, HasRoofsAndWallsOfABuildingWithAYard) {
  CityModel city;
  city.crs = "EPSG:28992";
  city.domain = {-50, -50, 50, 50};
  Building building;
  building.id = "b1";
  building.source_ids = {"a"};
  // An L, so that its roof is not convex, with a yard.
  building.footprint.outer = {{0, 0}, {30, 0}, {30, 10}, {12, 10}, {12, 24}, {0, 24}};
  building.footprint.holes = {{{4, 4}, {4, 8}, {9, 8}, {9, 4}}};
  building.h_ground = 2;
  building.h_roof = 12;
  city.buildings.push_back(building);
  const TemporaryFolder folder;
  write_city(folder / "city.city.json", city);
  const SurfaceMesh surface = read_city_surface(folder / "city.city.json").surface;
  EXPECT_NEAR(area_of(surface, Patch::kRoof, false), 30 * 10 + 12 * 14 - 5 * 4, 1e-9);
  EXPECT_NEAR(area_of(surface, Patch::kWall, false), 10 * (2 * (30 + 24) + 2 * (5 + 4)), 1e-9);
  EXPECT_EQ(area_of(surface, Patch::kGround, false), 0);
  for (const BuildingIndex b : surface.building) EXPECT_EQ(b, 0);
}

TEST(CitySurface, RoofsThatSlopeStayAsTheyAre) {
  const TemporaryFolder folder;
  const auto path = folder / "gable.city.json";
  // 10 x 8 m, eaves at 3 m, ridge at 6 m along the longer side; no semantics.
  testing::write_bytes(path, R"({"type":"CityJSON","version":"2.0",
    "transform":{"scale":[1,1,1],"translate":[0,0,0]},
    "CityObjects":{"a":{"type":"Building","geometry":[{"type":"Solid","lod":"2.2","boundaries":[[
      [[0,3,2,1]],[[0,1,5,4]],[[2,3,7,6]],[[1,2,6,9,5]],[[3,0,4,8,7]],[[4,5,9,8]],[[6,7,8,9]]]]}]}},
    "vertices":[[0,0,0],[10,0,0],[10,8,0],[0,8,0],[0,0,3],[10,0,3],[10,8,3],[0,8,3],[0,4,6],[10,4,6]]})");
  const SurfaceMesh surface = read_city_surface(path).surface;
  // The floor is one of the faces that are not walls: without semantics nobody says it is ground.
  EXPECT_NEAR(area_of(surface, Patch::kRoof, true), 2 * 80, 1e-9);
  EXPECT_NEAR(area_of(surface, Patch::kRoof, false), 80 + 2 * 10 * 5, 1e-9);
  EXPECT_NEAR(area_of(surface, Patch::kWall, false), 2 * 30 + 2 * (24 + 12), 1e-9);
}

TEST(CitySurface, SaysWhatIsNoCityJson) {
  const TemporaryFolder folder;
  for (const std::string text : {"", "{", "[]", "{\"type\":\"FeatureCollection\"}",
                                 "{\"type\":\"CityJSON\",\"version\":\"2.0\"}"}) {
    testing::write_bytes(folder / "a.json", text);
    testing::input_error(folder / "a.json", [&] { read_city_surface(folder / "a.json"); });
  }
  testing::write_bytes(folder / "a.json", R"({"type":"CityJSON")");
  EXPECT_NE(testing::input_error(folder / "a.json", [&] { read_city_surface(folder / "a.json"); })
                .find("ends at byte 18"),
            std::string::npos);
}

}  // namespace
}  // namespace tetropolis
