#include "tetropolis/io/crs/crs.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

TEST(Crs, EverySpellingHasOneName) {
  for (const char* text :
       {"EPSG:28992", "epsg:28992", " 28992\n", "EPSG:7415", "urn:ogc:def:crs:EPSG::7415",
        "urn:ogc:def:crs:EPSG::28992", "https://www.opengis.net/def/crs/EPSG/0/7415",
        "http://www.opengis.net/def/crs/EPSG/0/28992",
        "https://www.opengis.net/def/crs/EPSG/9.9.1/28992",
        "http://opengis.net/def/crs/EPSG/10.076/7415"})
    EXPECT_EQ(normalise_crs(text), "EPSG:28992") << text;
  EXPECT_EQ(normalise_crs(""), "");
  EXPECT_EQ(normalise_crs(" \n"), "");
  EXPECT_EQ(normalise_crs("WGS84"), "EPSG:4326");
  EXPECT_EQ(normalise_crs("EPSG:4979"), "EPSG:4326");
  EXPECT_EQ(normalise_crs("+proj=utm +zone=33 +datum=WGS84"), "EPSG:32633");
  const std::string compound =
      "https://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/2056&2=";
  EXPECT_EQ(normalise_crs(compound + "http://www.opengis.net/def/crs/EPSG/0/5728"), "EPSG:2056");
  EXPECT_NEAR(vertical_unit_metres(compound + "http://www.opengis.net/def/crs/EPSG/0/6360"),
              1200.0 / 3937, 1e-12);
}

TEST(Crs, ProjectionFilesOfRealDataAreRecognised) {
  TETROPOLIS_REQUIRE_DATA(root, ".");
  for (const auto& [file, code] : std::vector<std::pair<const char*, const char*>>{
           {"delft_3dfier/footprints.prj", "EPSG:28992"},
           {"boulder_wgs84/boulder_buildings.prj", "EPSG:4326"},
           {"dtcc_small/goteborg_by_14.prj", "EPSG:3006"},
           {"dtcc_small/MinimalCase_PropertyMap.prj", "EPSG:3857"},
           {"alexandria_dsm_dtm/footprints.prj", "EPSG:26918"},
           {"bielefeld_lod1_east/footprints.prj", "EPSG:25832"}}) {
    std::ifstream stream(root / file);
    const std::string wkt{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(normalise_crs(wkt), code) << file;
  }
}

TEST(Crs, SystemsWithoutACodeBecomeWkt) {
  const std::string name = normalise_crs("+proj=tmerc +lat_0=52 +lon_0=5.1 +ellps=GRS80 +units=m");
  EXPECT_EQ(name.substr(0, 8), "PROJCRS[");
  EXPECT_EQ(name.find('\n'), std::string::npos);
  EXPECT_EQ(normalise_crs(name), name);
  EXPECT_FALSE(is_geographic(name));
}

/// A Dutch grid that carries `code` as EPSG's; the national one with the usual false easting.
std::string wkt_with_code(const std::string& code, int easting = 155000) {
  return R"(PROJCS["Grid",GEOGCS["Amersfoort",DATUM["Amersfoort",SPHEROID["Bessel 1841",)"
         R"(6377397.155,299.1528128]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
         R"(PROJECTION["Oblique_Stereographic"],PARAMETER["latitude_of_origin",52.1561605555556],)"
         R"(PARAMETER["central_meridian",5.38763888888889],PARAMETER["scale_factor",0.9999079],)"
         R"(PARAMETER["false_easting",)" +
         std::to_string(easting) +
         R"(],PARAMETER["false_northing",463000],UNIT["metre",1],AUTHORITY["EPSG",")" + code +
         R"("]])";
}

TEST(Crs, CodesThatNobodyKnowsAreNotBelieved) {
  EXPECT_EQ(normalise_crs(wkt_with_code("28992")), "EPSG:28992");
  for (const char* code : {"102100", "no number"}) {
    EXPECT_EQ(normalise_crs(wkt_with_code(code)), "EPSG:28992") << code;
    const std::string name = normalise_crs(wkt_with_code(code, 20000));
    EXPECT_EQ(name.substr(0, 8), "PROJCRS[") << name;
    EXPECT_EQ(normalise_crs(name), name);
    EXPECT_EQ(linear_unit_metres(name), 1);
    EXPECT_EQ(crs_name(name), "Grid");
  }
  // The code of a system in metres on a definition in feet.
  std::string feet = wkt_with_code("28992");
  const std::string metre = R"(UNIT["metre",1],AUTHORITY)";
  feet.replace(feet.find(metre), metre.size(), R"(UNIT["foot",0.3048],AUTHORITY)");
  EXPECT_DOUBLE_EQ(linear_unit_metres(normalise_crs(feet)), 0.3048);
  // The code of a system in feet is believed.
  EXPECT_EQ(normalise_crs(wkt_with_code("2255")), "EPSG:2255");
}

TEST(Crs, NonsenseIsRefusedWithItsText) {
  for (const char* text :
       {"nowhere", "EPSG:999999", "EPSG:4978", "PROJCS[", "+proj=nothing", "/etc/hostname",
        "http://example.com/crs", "http://www.opengis.net/def/crs/EPSG/28992", "crs.txt",
        "LOCAL_CS[\"site\",UNIT[\"metre\",1]]",
        // What GDAL 3.9 and later write for none.
        "LOCAL_CS[\"Undefined SRS\",LOCAL_DATUM[\"unknown\",32767],UNIT[\"unknown\",0],"
        "AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH]]"}) {
    const std::string message = testing::error_of([&] { normalise_crs(text); }, ErrorKind::kUsage);
    EXPECT_NE(message.find(text), std::string::npos) << message;
  }
}

TEST(Crs, KnowsDegreesAndFeet) {
  EXPECT_TRUE(is_geographic("EPSG:4326"));
  EXPECT_FALSE(is_geographic("EPSG:28992"));
  EXPECT_FALSE(is_geographic(""));
  EXPECT_EQ(linear_unit_metres("EPSG:28992"), 1);
  EXPECT_EQ(linear_unit_metres(""), 1);
  EXPECT_EQ(linear_unit_metres("EPSG:4326"), 0);
  EXPECT_DOUBLE_EQ(linear_unit_metres("EPSG:2994"), 0.3048);
  EXPECT_DOUBLE_EQ(linear_unit_metres("EPSG:2225"), 1200.0 / 3937.0);
  const std::string site = normalise_crs(R"(LOCAL_CS["site",UNIT["foot",0.3048]])");
  EXPECT_EQ(normalise_crs(site), site);
  EXPECT_EQ(crs_name(site), "site");
  EXPECT_DOUBLE_EQ(linear_unit_metres(site), 0.3048);
}

TEST(Crs, KnowsHowLongAMetreIs) {
  // Web Mercator, a sphere's formula used for an ellipsoid: near 1 / cos(latitude).
  EXPECT_NEAR(length_scale("EPSG:3857", {1345678, 0}), 1, 0.01);
  const double at_58 = reproject(std::vector<Point2>{{12, 58}}, "EPSG:4326", "EPSG:3857")[0].y;
  EXPECT_NEAR(length_scale("EPSG:3857", {1345678, at_58}), 1 / std::cos(58 * M_PI / 180), 0.01);
  // On the central meridian, and at it in the Dutch system (EPSG 28992: 0.9999079).
  EXPECT_NEAR(length_scale("EPSG:3006", {500000, 6400000}), 0.9996, 1e-6);
  EXPECT_NEAR(length_scale("EPSG:28992", {155000, 463000}), 0.9999079, 1e-6);
  EXPECT_NEAR(length_scale("EPSG:2225", {6561667, 1640416}), 1, 0.001);  // US survey feet
  // Half a metre west and east of the meridian of 180 degrees, in the map grid of Fiji.
  EXPECT_NEAR(length_scale("EPSG:3460", {2133236.5, 4021710.2}), 1, 0.001);
  EXPECT_TRUE(std::isnan(length_scale("EPSG:4326", {12, 58})));
  EXPECT_TRUE(std::isnan(length_scale("", {12, 58})));
}

TEST(Crs, ComparesHorizontalParts) {
  EXPECT_TRUE(same_horizontal_crs("EPSG:7415", "EPSG:28992"));
  EXPECT_EQ(vertical_unit_metres("EPSG:7415"), 1);
  EXPECT_EQ(vertical_unit_metres("EPSG:28992"), 1);
  EXPECT_EQ(vertical_unit_metres(""), 1);
  EXPECT_EQ(vertical_unit_metres("no system"), 1);
  EXPECT_NEAR(vertical_unit_metres("EPSG:6339+6360"), 1200.0 / 3937, 1e-12);
  EXPECT_NEAR(vertical_unit_metres("EPSG:6360"), 1200.0 / 3937, 1e-12);
  EXPECT_NEAR(vertical_unit_metres("EPSG:8228"), 0.3048, 1e-12);  // NAVD88 height (ft)
  EXPECT_EQ(vertical_unit_metres("EPSG:28992+5715"), -1);         // MSL depth
  EXPECT_TRUE(same_horizontal_crs("EPSG:4979", "EPSG:4326"));
  EXPECT_TRUE(same_horizontal_crs("EPSG:3042", "EPSG:25830"));  // Axis order apart.
  EXPECT_FALSE(same_horizontal_crs("EPSG:25830", "EPSG:25831"));
  EXPECT_FALSE(same_horizontal_crs("EPSG:5513", "EPSG:5514"));  // South and west, east and north.
  EXPECT_FALSE(same_horizontal_crs("EPSG:2994", "EPSG:2991"));  // Feet and metres.
  EXPECT_FALSE(same_horizontal_crs("", ""));
  EXPECT_FALSE(same_horizontal_crs("EPSG:28992", ""));
}

TEST(Crs, ReprojectsEastFirst) {
  // Central meridian of UTM 33: easting 500 000; northing by the series of the meridian arc on
  // WGS 84 (Snyder 1987, eq. 3-21) times 0.9996.
  const double a = 6378137;
  const double e2 = (2 - 1 / 298.257223563) / 298.257223563;
  const double p = 59 * std::acos(-1.0) / 180;
  const double arc =
      a * ((1 - e2 / 4 - 3 * e2 * e2 / 64 - 5 * e2 * e2 * e2 / 256) * p -
           (3 * e2 / 8 + 3 * e2 * e2 / 32 + 45 * e2 * e2 * e2 / 1024) * std::sin(2 * p) +
           (15 * e2 * e2 / 256 + 45 * e2 * e2 * e2 / 1024) * std::sin(4 * p) -
           35 * e2 * e2 * e2 / 3072 * std::sin(6 * p));
  const std::vector<Point2> degrees = {{15, 59}, {15, 0}};
  for (const char* system : {"EPSG:32633", "EPSG:3006"}) {
    const std::vector<Point2> metres = reproject(degrees, "EPSG:4326", system);
    EXPECT_NEAR(metres[0].x, 500000, 1e-6) << system;
    EXPECT_NEAR(metres[0].y, 0.9996 * arc, 1e-3) << system;
    const std::vector<Point2> back = reproject(metres, system, "EPSG:4326");
    EXPECT_NEAR(back[0].x, 15, 1e-9);
    EXPECT_NEAR(back[0].y, 59, 1e-9);
  }
}

TEST(Crs, PointsBeyondAProjectionBecomeNaN) {
  const std::vector<Point2> points = {{15, 59}, {15, 95}, {std::nan(""), 59}, {16, 60}};
  const std::vector<Point2> result = reproject(points, "EPSG:4326", "EPSG:32633");
  ASSERT_EQ(result.size(), points.size());
  EXPECT_TRUE(std::isfinite(result[0].x));
  EXPECT_TRUE(std::isnan(result[1].x) && std::isnan(result[1].y));
  EXPECT_TRUE(std::isnan(result[2].x));
  EXPECT_TRUE(std::isfinite(result[3].x));
}

TEST(Crs, HasAShortName) {
  EXPECT_EQ(crs_name(""), "unknown");
  EXPECT_EQ(crs_name("EPSG:3006"), "EPSG:3006");
  const std::string local = normalise_crs("+proj=tmerc +lat_0=57 +lon_0=12 +units=us-ft");
  EXPECT_GT(local.size(), 100U);
  EXPECT_EQ(crs_name(local), "unnamed");
  EXPECT_EQ(crs_name(R"(LOCAL_CS["nowhere"])"), "unnamed");
  EXPECT_EQ(crs_name("no system at all"), "unnamed");
  std::string named = local;
  named.replace(named.find('"') + 1, 7, "Site\n" + std::string(100, 'x'));
  EXPECT_EQ(crs_name(named), "Site " + std::string(55, 'x') + "...");
  // Sixty bytes end within a character of two.
  named.replace(named.find("Site\n"), 105, std::string(59, 'x') + "\u00e5\u00e5");
  EXPECT_EQ(crs_name(named), std::string(59, 'x') + "...");
}

}  // namespace
}  // namespace tetropolis
