// Reference systems that files do not state, or state wrongly: degrees are never meshed, and the
// message names the option that helps.
#include "tetropolis/io/crs/crs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/report.h"
#include "tetropolis/run/run.h"

#include "support/test_data.h"
#include "village.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::Village;

const std::string kMetres = "EPSG:28992", kDegrees = "EPSG:4326";

Point2 in_degrees(const Village& village, Point2 p) {
  return reproject(std::array{Point2{p.x + village.origin.x, p.y + village.origin.y}}, kMetres,
                   kDegrees)[0];
}

class ReferenceSystems : public ::testing::Test {
 protected:
  /// Neither file states a system until a test has it do so.
  ReferenceSystems() { village.points_crs = village.footprints_crs = ""; }

  /// The origin is added again when they are written.
  void footprints_in_degrees() {
    for (Polygon& footprint : village.footprints)
      for (Point2& p : footprint.outer) {
        p = in_degrees(village, p);
        p = {p.x - village.origin.x, p.y - village.origin.y};
      }
  }

  void points_in_degrees() {
    for (std::size_t i = 0; i < village.cloud.size(); ++i) {
      const Point2 p = in_degrees(village, {village.cloud.x[i], village.cloud.y[i]});
      village.cloud.x[i] = p.x;
      village.cloud.y[i] = p.y;
    }
    village.points_are_local = false;
    village.points_scale = 1e-7;
  }

  void write() { village.write(scratch.path(), config); }

  /// What the run says; nothing may be left of it.
  std::string refusal() {
    try {
      run_city(config);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
      EXPECT_FALSE(fs::exists(config.out));
      return error.what();
    }
    return "no error";
  }

  void expect_refusal(const std::string& file, const std::string& why, const std::string& option) {
    const std::string message = refusal();
    for (const std::string& part : {file, why, option})
      EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
  }

  /// The run goes on, and the buildings are where the points are.
  void expect_village(const std::string& crs) {
    const Report report = run_city(config);
    EXPECT_EQ(report.crs, crs);
    const CityModel raw = read_city(fs::path(config.out) / "city_raw.city.json");
    ASSERT_EQ(raw.buildings.size(), Village().footprints.size());
    for (std::size_t b = 0; b < raw.buildings.size(); ++b) {
      const Bounds2 found = bounds(raw.buildings[b].footprint);
      const Bounds2 true_one = bounds(Village().footprints[b]);
      EXPECT_NEAR(found.xmin + raw.origin.x, true_one.xmin + 85000, 0.1) << b;
      EXPECT_NEAR(found.ymax + raw.origin.y, true_one.ymax + 447000, 0.1) << b;
    }
    EXPECT_GT(raw.buildings[0].n_roof_points, 200);
  }

  Village village;
  Config config;
  testing::TemporaryFolder scratch;
};

TEST_F(ReferenceSystems, PointsWithoutOneTakeThatOfProjectedFootprints) {
  village.footprints_crs = kMetres;
  write();
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, PointsWithoutOneAndFootprintsInDegreesNeedAnOption) {
  footprints_in_degrees();
  village.footprints_crs = kDegrees;
  village.footprints_file = "footprints.geojson";
  write();
  expect_refusal("footprints.geojson", "footprints are in degrees", "points_crs");
  config.points_crs = kMetres;
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, FootprintsWithoutOneThatLookLikeDegreesAreRefused) {
  footprints_in_degrees();
  for (const std::string& points_crs : {std::string(), kMetres}) {
    village.points_crs = points_crs;
    write();
    expect_refusal("footprints.shp", "coordinates look like degrees", "footprints_crs");
  }
  config.footprints_crs = kDegrees;
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, LatitudeBeforeLongitudeIsTold) {
  footprints_in_degrees();
  const Point2 at = village.origin;
  for (Polygon& footprint : village.footprints)  // west of America, so that it is no latitude
    for (Point2& p : footprint.outer) p = {p.y + at.y - at.x, p.x + at.x - at.y - 120};
  village.points_crs = kMetres;
  write();
  expect_refusal("footprints.shp", "latitude first", "exchange the two");
}

TEST_F(ReferenceSystems, FootprintsWithoutOneTakeThatOfThePoints) {
  village.points_crs = kMetres;
  write();
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, WithoutAnyMetresAreBelieved) {
  write();
  expect_village("");
}

TEST_F(ReferenceSystems, PointsWithoutOneThatLookLikeDegreesAreRefused) {
  points_in_degrees();
  write();
  expect_refusal("points.las", "coordinates look like degrees", "points_crs");
  // Taken for metres by the word of the footprints, they lie elsewhere.
  village.footprints_crs = kMetres;
  write();
  expect_refusal("points and domain do not overlap", "the points are x 4.4", "points_crs");
  // There is no system in which degrees are meshed.
  config.points_crs = kDegrees;
  expect_refusal("points.las", "coordinates are degrees", "points_crs");
}

TEST_F(ReferenceSystems, PointsThatClaimDegreesAreReadAsTheOptionSays) {
  village.points_crs = kDegrees;
  village.footprints_crs = kMetres;
  write();
  expect_refusal("points.las", "coordinates are degrees", "points_crs");
  config.points_crs = kMetres;
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, FootprintsInFeetAreNotTakenForThePointsSystem) {
  village.footprints_crs = "EPSG:2263";
  write();
  expect_refusal("footprints.shp", "in units of 0.3048", "points_crs");
  config.footprints_crs = kMetres;
  expect_village(kMetres);
}

const std::string kSiteInFeet = R"(LOCAL_CS["site",UNIT["foot",0.3048]])";

TEST_F(ReferenceSystems, FootprintsOfASiteInFeetAreNotTakenForMetres) {
  village.footprints_crs = kSiteInFeet;
  write();
  expect_refusal("footprints.shp", "in units of 0.3048 m (site)", "points_crs");
  config.points_crs = kMetres;
  expect_refusal("footprints.shp", "no transformation from site to EPSG:28992", "footprints_crs");
  config.footprints_crs = kMetres;
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, PointsOfASiteInFeetAreNotTakenForMetres) {
  village.points_crs = kSiteInFeet;
  village.point_format = 6;  // The older formats have no WKT.
  write();
  expect_refusal("points.las", "in units of 0.3048 m (site)", "reproject");
  config.points_crs = kMetres;
  expect_village(kMetres);
}

TEST_F(ReferenceSystems, TheSystemOfASiteInMetresIsUnknown) {
  village.points_crs = kMetres;
  write();
  std::ofstream(scratch / "footprints.prj") << R"(LOCAL_CS["site",UNIT["metre",1]])";
  expect_village(kMetres);
}

/// A terrain around the village, in another system.
void write_terrain(const fs::path& path, const Village& village, const std::string& crs) {
  const Bounds2 box = reproject_box(
      Bounds2{-200, -200, Village::kWidth + 200, Village::kDepth + 200}.moved(village.origin),
      kMetres, crs);
  const double step = box.width() / 20;
  std::ofstream file(path);
  file << std::setprecision(12) << "ncols 20\nnrows 20\nxllcorner " << box.xmin << "\nyllcorner "
       << box.ymin << "\ncellsize " << step << '\n';
  for (int i = 0; i < 400; ++i) file << "7\n";
}

TEST_F(ReferenceSystems, WithoutPointsTheCityIsInThatOfTheFirstThatIsTrueToScale) {
  const std::string mercator = "EPSG:3857", utm = "EPSG:32631";
  village.footprints_crs = kMetres;
  write();
  config.points.clear();
  config.dtm = {(scratch / "terrain.asc").string()};
  const Bounds2 bounds{85000, 447000, 85055, 447080};
  const Bounds2 in_utm = reproject_box(bounds, kMetres, utm);
  const auto expect = [&](const std::string& raster_crs, const std::string& crs,
                          const Bounds2& box) {
    SCOPED_TRACE(raster_crs);
    write_terrain(config.dtm.front(), village, raster_crs);
    config.raster_crs = raster_crs;
    for (const std::vector<double>& sides :
         {std::vector<double>{}, std::vector{box.xmin, box.ymin, box.xmax, box.ymax}}) {
      config.bounds = sides;
      const Report report = run_city(config);
      EXPECT_EQ(report.crs, crs);
      EXPECT_EQ(report.city->raw_buildings, sides.empty() ? 7 : 4);
      const auto& warnings = report.warnings;
      EXPECT_EQ(std::any_of(warnings.begin(), warnings.end(),
                            [](const Warning& w) { return w.code == "crs_chosen"; }),
                crs == utm && raster_crs != utm);
    }
  };
  for (const std::string& raster_crs : {kDegrees, mercator, kMetres})
    expect(raster_crs, kMetres, bounds);
  expect(utm, utm, in_utm);
  footprints_in_degrees();
  village.footprints_crs = kDegrees;
  village.footprints_file = "footprints.geojson";
  write();
  config.points.clear();
  expect(kDegrees, utm, in_utm);
  expect(mercator, utm, in_utm);
  expect(kMetres, kMetres, bounds);
}

}  // namespace
}  // namespace tetropolis
