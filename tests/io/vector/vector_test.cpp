#include "tetropolis/io/vector/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <variant>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"

#include "io/file/input_paths.h"
#include "io/vector/merge_footprints.h"
#include "io/vector/vector_geometry.h"
#include "support/bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::TemporaryFolder;

fs::path write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  return path;
}

std::set<std::string> listing(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

/// Names and bytes of everything in a folder.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : listing(folder))
    if (fs::is_regular_file(folder / name)) files[name] = bytes_of(folder / name);
  return files;
}

std::string input_error(const fs::path& path, const ReadFootprintsOptions& options = {}) {
  return testing::input_error(path, [&] { read_footprints(path, options); });
}

bool has_warning(const FootprintsInput& input, const std::string& code) {
  for (const Warning& warning : input.warnings)
    if (warning.code == code) return true;
  return false;
}

/// What holds for every input.
void check_account(const FootprintsInput& input) {
  std::set<std::string> ids;
  for (const Footprint& feature : input.features) {
    EXPECT_TRUE(ids.insert(feature.source_id).second) << feature.source_id;
    ASSERT_GE(feature.polygon.outer.size(), 3U);
    EXPECT_FALSE(feature.polygon.outer.front() == feature.polygon.outer.back());
    for (const Point2& p : feature.polygon.outer) {
      EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
      EXPECT_TRUE(input.bounds.contains(p));
    }
  }
  for (const Dropped& dropped : input.dropped) {
    EXPECT_TRUE(ids.insert(dropped.source_id).second) << dropped.source_id;
    EXPECT_FALSE(dropped.reason.empty());
  }
  EXPECT_GE(static_cast<std::int64_t>(ids.size()), input.features_read);
  EXPECT_EQ(input.bounds.empty(), input.features.empty());
}

double total_area(const FootprintsInput& input) {
  double sum = 0;
  for (const Footprint& feature : input.features) sum += area(feature.polygon);
  return sum;
}

TEST(Vector, ReadsTheRealFootprints) {
  TETROPOLIS_REQUIRE_DATA(root, ".");
  struct Case {
    const char* path;
    std::int64_t features;
    std::size_t polygons;
    const char* crs;
    double area;  // From the README; 0: not stated.
  };
  for (const Case& c : std::vector<Case>{
           {"delft_3dfier/footprints.shp", 160, 160, "EPSG:28992", 8654},
           {"delft_3dfier/footprints.gpkg", 160, 160, "EPSG:28992", 8654},
           {"delft_3dfier/bgt_pand.sqlite", 160, 160, "EPSG:28992", 8654},
           {"amsterdam_south/footprints.shp", 800, 800, "EPSG:28992", 123721},
           {"amsterdam_south/footprints.gpkg", 800, 800, "EPSG:28992", 123721},
           {"amsterdam_south/footprints_bag2017.geojson", 798, 798, "EPSG:28992", 0},
           {"tudelft_campus_bag/footprints.shp", 2833, 2833, "EPSG:28992", 757879},
           {"tudelft_campus_bag/tudcampus_bag2017.geojson", 2833, 2833, "EPSG:28992", 757879},
           {"alexandria_dsm_dtm/footprints.shp", 84, 84, "EPSG:26918", 0},
           {"alexandria_dsm_dtm/buildings_wgs84.geojson", 84, 84, "EPSG:4326", 0},
           {"bielefeld_lod1_east/footprints.shp", 3166, 3166, "EPSG:25832", 0},
           {"boulder_wgs84/boulder_buildings.shp", 13491, 13638, "EPSG:4326", 0},
           {"dtcc_small/goteborg_by_14.shp", 169, 172, "EPSG:3006", 0},
           {"dtcc_small/MinimalCase_PropertyMap.shp", 3, 5, "EPSG:3857", 0},
           {"dtcc_small/gpk1.gpkg", 3, 3, "EPSG:3857", 0},
           {"dtcc_small/gpk2.gpkg", 2, 2, "EPSG:3857", 0}}) {
    SCOPED_TRACE(c.path);
    const FootprintsInput input = read_footprints(root / c.path);
    EXPECT_EQ(input.features_read, c.features);
    EXPECT_EQ(input.features.size(), c.polygons);
    EXPECT_TRUE(input.dropped.empty());
    EXPECT_EQ(input.crs, c.crs);
    if (c.area > 0) {
      EXPECT_NEAR(total_area(input), c.area, 1);
    }
    for (const Warning& warning : input.warnings) EXPECT_EQ(warning.code, "height_assumed");
    check_account(input);
  }
}

TEST(Vector, SamplesLoadOrFailCleanly) {
  TETROPOLIS_REQUIRE_DATA(samples, "vector_samples");
  // On copies: a reader that writes where it should not must not reach the data.
  const TemporaryFolder scratch;
  fs::copy(samples, scratch / "samples", fs::copy_options::recursive);
  const fs::path folder = scratch / "samples";
  struct Case {
    const char* path;
    std::int64_t features;
    std::size_t polygons;
    std::size_t dropped;
  };
  for (const Case& c :
       std::vector<Case>{{"shapefile/shplib/polygon.shp", 474, 474, 0},
                         {"shapefile/shplib/anno.shp", 201, 201, 0},
                         {"shapefile/shplib/csah.shp", 124, 0, 124},
                         {"shapefile/shplib/pline.shp", 460, 0, 460},
                         {"shapefile/shplib/brklinz.shp", 122, 0, 122},
                         {"shapefile/shplib/masspntz.shp", 815, 0, 815},
                         {"shapefile/shplib/multipnt.shp", 1, 0, 1},
                         {"shapefile/three_points.shp", 3, 0, 3},
                         {"shapefile/polygons.shp", 3, 4, 0},
                         {"shapefile/polygons.json", 3, 4, 0},
                         {"shapefile/ignore-properties.shp", 3, 0, 3},
                         {"shapefile/ignore-properties.json", 3, 0, 3},
                         {"issues/518_519_shp_reading/data_corruption_error.shp", 8, 0, 8},
                         {"issues/518_519_shp_reading/max_callstack_error.shp", 138, 0, 138},
                         {"issues/538_missing_holes/multipolygon.json", 1, 2, 0},
                         {"issues/384_invalid_json/ex2.json", 2, 2, 0},
                         {"issues/384_invalid_json/sample1.json", 2, 2, 0},
                         {"features/explode/ex1_invalid_rings.json", 1, 1, 0},
                         {"features/explode/ex2_nesting.json", 1, 2, 0},
                         {"geojson/six_counties_three_null.json", 6, 5, 3},
                         {"geopackage/Oregon.gpkg", 1, 9, 0}}) {
    SCOPED_TRACE(c.path);
    const fs::path parent = (folder / c.path).parent_path();
    const std::map<std::string, std::string> before = contents(parent);
    const FootprintsInput input = read_footprints(folder / c.path);
    EXPECT_EQ(input.features_read, c.features);
    EXPECT_EQ(input.features.size(), c.polygons);
    EXPECT_EQ(input.dropped.size(), c.dropped);
    EXPECT_EQ(input.layer, c.polygons == 9 ? "land" : fs::path(c.path).stem().string());
    EXPECT_TRUE(contents(parent) == before) << "reading changed a file";
    check_account(input);
  }
  input_error(folder / "issues/384_invalid_json/sample.json");
  // Its index has entries that point into the file's head.
  input_error(folder / "shapefile/shplib/3dpoints.shp");
  EXPECT_NE(input_error(folder / "geopackage/data_only_tables.gpkg").find("no layer of polygons"),
            std::string::npos);
  TETROPOLIS_REQUIRE_DATA(cloud, "las_only/lyon_dense_vegetation.las");
  EXPECT_NE(input_error(cloud).find("not a vector file"), std::string::npos);
}

TEST(Vector, MetresInGeoJsonWithoutCrsAreNoDegrees) {
  TETROPOLIS_REQUIRE_DATA(folder, "vector_samples/issues/384_invalid_json");
  const FootprintsInput input = read_footprints(folder / "ex2.json");
  EXPECT_EQ(input.crs, "");
  EXPECT_TRUE(has_warning(input, "footprints_crs_implausible"));
  ReadFootprintsOptions options;
  options.source_crs = "EPSG:3857";
  options.target_crs = "EPSG:4326";
  const FootprintsInput stated = read_footprints(folder / "ex2.json", options);
  EXPECT_EQ(stated.crs, "EPSG:4326");
  EXPECT_FALSE(has_warning(stated, "footprints_crs_implausible"));
  EXPECT_NEAR(stated.bounds.xmin, -20.194, 1e-3);
}

TEST(Vector, ReprojectsToTheCloudsSystem) {
  TETROPOLIS_REQUIRE_DATA(folder, "alexandria_dsm_dtm");
  ReadFootprintsOptions options;
  options.target_crs = "EPSG:26918";
  const FootprintsInput moved = read_footprints(folder / "buildings_wgs84.geojson", options);
  const FootprintsInput reference = read_footprints(folder / "footprints.shp", options);
  ASSERT_EQ(moved.features.size(), reference.features.size());
  EXPECT_EQ(moved.crs, "EPSG:26918");
  check_account(moved);
  for (std::size_t i = 0; i < moved.features.size(); ++i)
    EXPECT_NEAR(area(moved.features[i].polygon), area(reference.features[i].polygon), 0.01);
  EXPECT_NEAR(moved.bounds.xmin, reference.bounds.xmin, 0.01);
  EXPECT_NEAR(moved.bounds.ymax, reference.bounds.ymax, 0.01);
  // A compound target is its horizontal part; equal systems leave the numbers alone.
  TETROPOLIS_REQUIRE_DATA(delft, "delft_3dfier/footprints.shp");
  options.target_crs = "EPSG:7415";
  const FootprintsInput same = read_footprints(delft, options);
  EXPECT_EQ(same.crs, "EPSG:28992");
  EXPECT_EQ(same.bounds, read_footprints(delft).bounds);
}

/// Without rings: whether the box of a feature meets another.
Bounds2 box_of(const Footprint& feature) {
  Bounds2 box = Bounds2::nothing();
  for (const Point2& p : feature.polygon.outer) box.extend(p);
  return box;
}

TEST(Vector, OfFeaturesBeyondABoxTheIdsAreRead) {
  TETROPOLIS_REQUIRE_DATA(path, "amsterdam_south/footprints.gpkg");
  ReadFootprintsOptions options;
  options.attributes = true;
  const FootprintsInput all = read_footprints(path, options);
  const Point2 middle{(all.bounds.xmin + all.bounds.xmax) / 2,
                      (all.bounds.ymin + all.bounds.ymax) / 2};
  options.within = {all.bounds.xmin, all.bounds.ymin, middle.x - 100, middle.y - 100};
  const FootprintsInput near = read_footprints(path, options);
  check_account(near);
  EXPECT_EQ(near.features_read, all.features_read);
  EXPECT_EQ(near.unlisted, 0);
  const Bounds2 kept = options.within.grown(100);
  std::size_t next = 0;
  std::set<std::string> beyond;
  for (const UnusableFootprint& dropped : near.dropped) {
    EXPECT_EQ(dropped.cause, DropCause::kOutside);
    EXPECT_EQ(dropped.reason, "outside the domain");
    EXPECT_EQ(dropped.feature, -1);
    beyond.insert(dropped.source_id);
  }
  for (const Footprint& feature : all.features) {
    EXPECT_EQ(beyond.contains(feature.source_id), !box_of(feature).intersects(kept));
    if (!box_of(feature).intersects(kept)) continue;
    ASSERT_LT(next, near.features.size());
    const Footprint& same = near.features[next++];
    EXPECT_EQ(same.source_id, feature.source_id);
    EXPECT_EQ(same.polygon.outer, feature.polygon.outer);
    ASSERT_EQ(near.attributes.size(), all.attributes.size());
    for (std::size_t c = 0; c < all.attributes.size(); ++c) {
      const auto row = static_cast<std::size_t>(feature.feature);
      const auto own = static_cast<std::size_t>(same.feature);
      ASSERT_EQ(near.attributes[c].known[own], all.attributes[c].known[row]);
      std::visit(
          [&](const auto& values) {
            EXPECT_EQ(std::get<std::decay_t<decltype(values)>>(near.attributes[c].values)[own],
                      values[row]);
          },
          all.attributes[c].values);
    }
  }
  EXPECT_EQ(next, near.features.size());
  EXPECT_GT(beyond.size(), 100U);
  EXPECT_GT(next, 50U);
}

TEST(Vector, ABoxInAnotherSystemKeepsWhatIsInIt) {
  TETROPOLIS_REQUIRE_DATA(path, "alexandria_dsm_dtm/buildings_wgs84.geojson");
  ReadFootprintsOptions options;
  options.target_crs = "EPSG:26918";
  const FootprintsInput all = read_footprints(path, options);
  const double x = all.bounds.xmin, y = all.bounds.ymin;
  options.within = {x - 50, y - 50, x + 40, y + 40};
  options.within_crs = options.target_crs;
  const FootprintsInput near = read_footprints(path, options);
  check_account(near);
  std::set<std::string> kept;
  for (const Footprint& feature : near.features) {
    kept.insert(feature.source_id);
    EXPECT_TRUE(box_of(feature).intersects(options.within.grown(200))) << feature.source_id;
  }
  EXPECT_LT(kept.size(), all.features.size());
  std::size_t inside = 0;
  for (const Footprint& feature : all.features)
    if (box_of(feature).intersects(options.within)) {
      ++inside;
      EXPECT_TRUE(kept.contains(feature.source_id)) << feature.source_id;
    }
  EXPECT_GT(inside, 0U);
}

TEST(Vector, ABoxDoesNotMatterWhereCoordinatesMayBeAnything) {
  const TemporaryFolder folder;
  const auto square = [](double x) {
    return fmt::format(
        R"({{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[[[{0},0],[{1},0],[{1},9],[{0},9],[{0},0]]]}}}})",
        x, x + 9);
  };
  const auto read = [&](const std::string& crs, const std::string& within_crs) {
    ReadFootprintsOptions options;
    options.within = {1000, 0, 2000, 100};
    options.within_crs = within_crs;
    return read_footprints(
        write_text(folder / "a.geojson",
                   fmt::format(R"({{"type":"FeatureCollection",{}"features":[{},{}]}})", crs,
                               square(1500), square(1e5))),
        options);
  };
  const auto named = [](const char* code) {
    return fmt::format(R"("crs":{{"type":"name","properties":{{"name":"{}"}}}},)", code);
  };
  // Metres in a file that says degrees; a system in which a unit is no metre; none.
  EXPECT_EQ(read("", "EPSG:28992").features.size(), 2U);
  EXPECT_EQ(read(named("EPSG:2263"), "").features.size(), 2U);
  EXPECT_EQ(read(named("EPSG:28992"), "").features.size(), 1U);
  EXPECT_EQ(read(named("EPSG:28992"), "EPSG:28992").features.size(), 1U);
  // A system of a site, which nothing leads to.
  EXPECT_EQ(read(named("EPSG:28992"), R"(LOCAL_CS["site",UNIT["foot",0.3048]])").features.size(),
            2U);
  const fs::path shapes = folder / "a.shp";
  const std::vector<Polygon> polygons{Polygon{{{0, 0}, {9, 0}, {9, 9}}, {}}};
  write_footprints(shapes, polygons, std::vector<std::string>{"far"}, {}, {}, "");
  ReadFootprintsOptions options;
  options.within = {1000, 0, 2000, 100};
  options.within_crs = "EPSG:28992";
  EXPECT_EQ(read_footprints(shapes, options).features.size(), 1U);
}

TEST(Vector, IdsAndHeightsComeFromAttributes) {
  TETROPOLIS_REQUIRE_DATA(bielefeld, "bielefeld_lod1_east/footprints.shp");
  ReadFootprintsOptions options;
  options.id_attribute = "gml_id";
  options.height_attribute = "height";
  const FootprintsInput input = read_footprints(bielefeld, options);
  double low = 1e9;
  double high = 0;
  for (const Footprint& feature : input.features) {
    low = std::min(low, feature.height);
    high = std::max(high, feature.height);
  }
  EXPECT_NEAR(low, 1.0, 0.01);
  EXPECT_NEAR(high, 35, 0.5);
  check_account(input);
  options.id_attribute = "no_such";
  const std::string message = input_error(bielefeld, options);
  EXPECT_NE(message.find("'no_such'"), std::string::npos);
  EXPECT_NE(message.find("gml_id, parent"), std::string::npos) << message;
  options = {};
  options.height_attribute = "hight";
  EXPECT_NE(input_error(bielefeld, options).find("z_roof"), std::string::npos);
  options = {};
  options.layer = "houses";
  EXPECT_NE(input_error(bielefeld, options).find("it has: footprints"), std::string::npos);
}

TEST(Vector, YesAndNoAreNoHeights) {
  const TemporaryFolder folder;
  ReadFootprintsOptions options;
  options.height_attribute = "listed";
  const std::string message = input_error(
      write_text(folder / "listed.geojson",
                 R"({"type":"Feature","properties":{"listed":true},"geometry":{"type":"Polygon",
                 "coordinates":[[[0,0],[9,0],[9,8],[0,8],[0,0]]]}})"),
      options);
  EXPECT_NE(message.find("'listed' is Boolean, not a height"), std::string::npos) << message;
}

TEST(Vector, DuplicateIdsAreToldApart) {
  TETROPOLIS_REQUIRE_DATA(goteborg, "dtcc_small/goteborg_by_14.shp");
  ReadFootprintsOptions options;
  options.id_attribute = "OBJEKT_ID";
  const FootprintsInput input = read_footprints(goteborg, options);
  check_account(input);
  std::set<std::string> plain;
  std::size_t parts = 0;
  std::size_t repeated = 0;
  for (const Footprint& feature : input.features) {
    const std::string& id = feature.source_id;
    parts += id.find('#') != std::string::npos ? 1 : 0;
    repeated += id.find('~') != std::string::npos ? 1 : 0;
    plain.insert(id.substr(0, id.find_first_of("#~")));
  }
  EXPECT_EQ(plain.size(), 153U);
  EXPECT_EQ(parts, 3U);
  EXPECT_EQ(repeated, 16U);
  EXPECT_TRUE(has_warning(input, "duplicate_ids"));
}

const std::string kMixed = R"({"type":"FeatureCollection","features":[
 {"type":"Feature","properties":{"name":"a","h":"12.5"},"geometry":{"type":"MultiPolygon","coordinates":
   [[[[0,0,7],[4,0,7],[4,4,7],[0,4,7],[0,0,7]],[[1,1],[1,2],[2,2],[1,1]]],
    [[[9,9],[9,9]]],
    [[[6,0],[8,0],[8,2],[6,0]]]]}},
 {"type":"Feature","properties":{"name":"a#2","h":null},"geometry":{"type":"Polygon","coordinates":
   [[[0,6],[1,6],[1,7],[0,6]]]}},
 {"type":"Feature","properties":{"name":null,"h":"tall"},"geometry":{"type":"Polygon","coordinates":
   [[[0,8],[1,8],[1,9],[0,8]]]}},
 {"type":"Feature","properties":{"name":"c"},"geometry":null},
 {"type":"Feature","properties":{"name":"d"},"geometry":{"type":"Polygon","coordinates":[]}},
 {"type":"Feature","properties":{"name":"a"},"geometry":{"type":"GeometryCollection","geometries":[
   {"type":"Point","coordinates":[1,1]},
   {"type":"Polygon","coordinates":[[[3,8],[4,8],[4,9],[3,8]]]}]}}]})";

TEST(Vector, SplitsFlattensAndAccounts) {
  const TemporaryFolder folder;
  ReadFootprintsOptions options;
  options.id_attribute = "name";
  options.height_attribute = "h";
  const FootprintsInput input =
      read_footprints(write_text(folder / "mixed.geojson", kMixed), options);
  check_account(input);
  EXPECT_EQ(input.features_read, 6);
  std::vector<std::string> ids;
  for (const Footprint& feature : input.features) ids.push_back(feature.source_id);
  EXPECT_EQ(ids, (std::vector<std::string>{"a", "a#3", "a#2~2", "2", "a~2"}));
  ASSERT_EQ(input.dropped.size(), 3U);
  EXPECT_EQ(input.dropped[0].source_id, "a#2");
  EXPECT_EQ(input.dropped[0].reason, "a polygon of fewer than three vertices");
  EXPECT_EQ(input.dropped[1].source_id, "c");
  EXPECT_EQ(input.dropped[1].reason, "no geometry");
  EXPECT_EQ(input.dropped[2].source_id, "d");
  EXPECT_EQ(input.features[0].polygon.outer, (Ring{{0, 0}, {4, 0}, {4, 4}, {0, 4}}));
  ASSERT_EQ(input.features[0].polygon.holes.size(), 1U);
  EXPECT_EQ(input.features[0].polygon.holes[0], (Ring{{1, 1}, {1, 2}, {2, 2}}));
  EXPECT_EQ(input.features[0].height, 12.5);
  EXPECT_EQ(input.features[1].height, 12.5);
  EXPECT_TRUE(std::isnan(input.features[2].height));
  EXPECT_TRUE(std::isnan(input.features[3].height));
  EXPECT_TRUE(has_warning(input, "duplicate_ids"));
  EXPECT_TRUE(has_warning(input, "missing_ids"));
  EXPECT_TRUE(has_warning(input, "mixed_geometry"));
  EXPECT_EQ(input.crs, "EPSG:4326");
}

TEST(Vector, AYardGivenFirstIsNoBuilding) {
  const TemporaryFolder folder;
  const FootprintsInput input = read_footprints(
      write_text(folder / "yard.geojson",
                 R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[
      [[2,2],[2,4],[6,4],[6,2],[2,2]],[[0,0],[9,0],[9,8],[0,8],[0,0]]]}})"));
  ASSERT_EQ(input.features.size(), 1U);
  const Polygon& polygon = input.features[0].polygon;
  EXPECT_EQ(polygon.outer, (Ring{{0, 0}, {9, 0}, {9, 8}, {0, 8}}));
  ASSERT_EQ(polygon.holes.size(), 1U);
  EXPECT_EQ(polygon.holes[0], (Ring{{2, 2}, {2, 4}, {6, 4}, {6, 2}}));
}

TEST(Vector, WhatIsNestedTooDeepIsNotLostSilently) {
  const TemporaryFolder folder;
  std::string deep = R"({"type":"Polygon","coordinates":[[[3,8],[4,8],[4,9],[3,8]]]})";
  for (int level = 0; level < 40; ++level)
    deep = R"({"type":"GeometryCollection","geometries":[)" + deep + "]}";
  const FootprintsInput input = read_footprints(write_text(
      folder / "deep.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":)"
      R"({"type":"GeometryCollection","geometries":[)"
      R"({"type":"Polygon","coordinates":[[[0,6],[1,6],[1,7],[0,6]]]},)" +
          deep + "]}}]}"));
  EXPECT_EQ(input.features.size(), 1U);
  EXPECT_TRUE(has_warning(input, "mixed_geometry"));
}

TEST(Vector, WarningsAreOneLineWhateverTheyQuote) {
  const TemporaryFolder folder;
  const fs::path path = write_text(folder / "a.geojson", R"({"type":"FeatureCollection","features":[
 {"type":"Feature","properties":{"na\nme":null,"h\te":"9 m"},"geometry":{"type":"Polygon",
  "coordinates":[[[0,6],[1,6],[1,7],[0,6]]]}},
 {"type":"Feature","properties":{"na\nme":"a\nb","h\te":"\u001b[31m high"},"geometry":{"type":"Polygon",
  "coordinates":[[[0,8],[1,8],[1,9],[0,8]]]}}]})");
  ReadFootprintsOptions options;
  options.id_attribute = "na\nme";
  options.height_attribute = "h\te";
  const FootprintsInput input = read_footprints(path, options);
  EXPECT_TRUE(has_warning(input, "missing_ids"));
  EXPECT_TRUE(has_warning(input, "height_not_a_number"));
  for (const Warning& warning : input.warnings)
    EXPECT_TRUE(std::none_of(warning.message.begin(), warning.message.end(), [](char c) {
      return static_cast<unsigned char>(c) < ' ';
    })) << warning.message;
}

TEST(Vector, NumbersAsIdsKeepTheirDigits) {
  const TemporaryFolder folder;
  std::string features;
  for (const char* id : {"9007199254740991.0", "9007199254740990.0", "0.5", "3.0", "0.1"})
    features += std::string(features.empty() ? "" : ",") +
                R"({"type":"Feature","properties":{"id":)" + id +
                R"(},"geometry":{"type":"Polygon","coordinates":[[[3,8],[4,8],[4,9],[3,8]]]}})";
  ReadFootprintsOptions options;
  options.id_attribute = "id";
  const FootprintsInput input =
      read_footprints(write_text(folder / "a.geojson",
                                 R"({"type":"FeatureCollection","features":[)" + features + "]}"),
                      options);
  std::vector<std::string> ids;
  for (const Footprint& feature : input.features) ids.push_back(feature.source_id);
  EXPECT_EQ(ids,
            (std::vector<std::string>{"9007199254740991", "9007199254740990", "0.5", "3", "0.1"}));
  EXPECT_FALSE(has_warning(input, "duplicate_ids"));
}

TEST(Vector, QuotesThatSwallowLinesAreErrors) {
  const TemporaryFolder folder;
  const std::string polygon = "\"POLYGON((3 8,4 8,4 9,3 8))\"\n";
  const auto read = [&](const std::string& rows) {
    return read_footprints(write_text(folder / "a.csv", "id,name,WKT\n" + rows)).features.size();
  };
  EXPECT_EQ(read("1,x," + polygon + "2,\"two\nlines\"," + polygon + "3,y," + polygon), 3U);
  EXPECT_EQ(read("1,\"a \"\"b\"\" c\"," + polygon + "2,pipe 5\" to 6\"," + polygon), 2U);
  EXPECT_EQ(read("1,\"5\"\" to\n6\"\"\"," + polygon + "2,x," + polygon), 2U);
  for (const auto& [broken, line] :
       {std::pair{"2,\"Bakery," + polygon, "line 3: "},
        std::pair{std::string("2,x,POLYGON((3 8,4 8,4 9,3 8))\"\n"), "line 3: "},
        std::pair{"2,\"Bakery," + polygon + "3,x," + polygon + "4,\"Butcher," + polygon,
                  "line 3: "},
        std::pair{std::string("2,x,\"POLYGON((3 8,4 8"), "line 3: "}}) {
    SCOPED_TRACE(broken);
    const std::string message = testing::error_of([&, &broken = broken] {
      read("1,x," + polygon + broken + (broken.back() == '\n' ? "9,x," + polygon : ""));
    });
    EXPECT_NE(message.find(line), std::string::npos) << message;
    EXPECT_NE(message.find("quote"), std::string::npos) << message;
  }
}

TEST(Vector, TheVeryNameOfAnAttributeComesBeforeOthers) {
  const TemporaryFolder folder;
  const fs::path path =
      write_text(folder / "a.csv", "ID,id,WKT\nlarge,small,\"POLYGON((3 8,4 8,4 9,3 8))\"\n");
  for (const auto& [name, id] :
       {std::pair{"ID", "large"}, std::pair{"id", "small"}, std::pair{"Id", "large"}}) {
    ReadFootprintsOptions options;
    options.id_attribute = name;
    EXPECT_EQ(read_footprints(path, options).features.at(0).source_id, id) << name;
  }
}

TEST(Vector, WhatMarksUnknownHeightsIsNone) {
  const TemporaryFolder folder;
  std::string rows = "h,WKT\n";
  for (const char* height : {"9999", "999", "998", "1100", "1101", "-9999"})
    rows += std::string(height) + ",\"POLYGON((3 8,4 8,4 9,3 8))\"\n";
  ReadFootprintsOptions options;
  options.height_attribute = "h";
  const FootprintsInput input = read_footprints(write_text(folder / "a.csv", rows), options);
  ASSERT_EQ(input.features.size(), 6U);
  for (const std::size_t none : {0, 1, 4}) EXPECT_TRUE(std::isnan(input.features[none].height));
  EXPECT_EQ(input.features[2].height, 998);
  EXPECT_EQ(input.features[3].height, 1100);
  EXPECT_EQ(input.features[5].height, -9999) << "below 0: not used, as any such";
  EXPECT_TRUE(has_warning(input, "height_not_a_number"));
}

TEST(Vector, PolygonsInTablesAreFoundByTheUsualNames) {
  const TemporaryFolder folder;
  for (const char* name : {"WKT", "wkt", "geometry", "geom", "the_geom", "GEOM", "wkb", ".geo"}) {
    const FootprintsInput input = read_footprints(write_text(
        folder / "a.csv", std::string("id,") + name + "\n1,\"POLYGON((3 8,4 8,4 9,3 8))\"\n"));
    EXPECT_EQ(input.features.size(), 1U) << name;
  }
  // Columns of such names may hold something else.
  for (const char* header : {"shape,WKT", "footprint,geometry", "geom,geometry", "WKT2,WKT"}) {
    const FootprintsInput input = read_footprints(write_text(
        folder / "a.csv", std::string(header) + "\ngabled,\"POLYGON((3 8,4 8,4 9,3 8))\"\n"));
    EXPECT_EQ(input.features.size(), 1U) << header;
  }
  const std::string message = testing::error_of([&] {
    read_footprints(write_text(folder / "b.csv", "id,outline\n1,\"POLYGON((3 8,4 8,4 9,3 8))\"\n"));
  });
  EXPECT_NE(message.find("call it WKT"), std::string::npos) << message;
}

/// Its driver has the system at the layer, not at the geometries.
TEST(Vector, MifFilesKeepTheirReferenceSystem) {
  const TemporaryFolder folder;
  write_text(folder / "a.mid", "7\n");
  const FootprintsInput input = read_footprints(write_text(
      folder / "a.mif",
      "Version 300\nCharset \"Neutral\"\nDelimiter \",\"\n"
      "CoordSys Earth Projection 8, 115, \"m\", 9, 0, 0.9996, 500000, 0\nColumns 1\n  id Integer\n"
      "Data\n\nRegion 1\n  4\n0 0\n9 0\n9 9\n0 0\n"));
  EXPECT_EQ(input.features.size(), 1U);
  EXPECT_EQ(input.crs, "EPSG:25832");
}

/// A point of each building, say of its entrance, before its outline.
TEST(Vector, OfSeveralGeometryFieldsThatOfPolygonsIsRead) {
  const TemporaryFolder folder;
  write_text(folder / "a.csv",
             "id,entrance,outline\n7,POINT(4 9),\"POLYGON((3 8,4 8,4 9,3 8))\"\n");
  const auto field = [](const char* name, const std::string& type, const char* srs) {
    return fmt::format(
        R"(<GeometryField name="{0}" encoding="WKT" field="{0}">{1}<SRS>{2}</SRS></GeometryField>)",
        name, type, srs);
  };
  // As declared, as not declared, and as GDAL declares them in GML.
  const std::string point = "<GeometryType>wkbPoint</GeometryType>",
                    polygon = "<GeometryType>wkbPolygon</GeometryType>";
  for (const auto& [first, second] : {std::pair{point, polygon}, {point, ""}, {polygon, polygon}}) {
    const fs::path path = write_text(
        folder / "a.vrt",
        R"(<OGRVRTDataSource><OGRVRTLayer name="a"><SrcDataSource relativeToVRT="1">a.csv)"
        "</SrcDataSource>" +
            field("entrance", first, "EPSG:4326") + field("outline", second, "EPSG:28992") +
            "</OGRVRTLayer></OGRVRTDataSource>");
    const FootprintsInput input = read_footprints(path);
    ASSERT_EQ(input.features.size(), 1U) << first << second;
    EXPECT_EQ(area(input.features[0].polygon), 0.5);
    EXPECT_EQ(input.crs, "EPSG:28992");
    EXPECT_TRUE(list_layers(path).at(0).holds_polygons);
  }
}

TEST(Vector, AttributesInTablesOfUnknownEncodingAreFound) {
  const TemporaryFolder folder;
  write_footprints(folder / "a.shp", std::vector<Polygon>{{{{0, 0}, {9, 0}, {9, 9}}, {}}},
                   std::vector<std::string>{"x"}, std::vector<double>{7}, {}, "EPSG:28992");
  fs::remove(folder / "a.cpg");
  std::string table = bytes_of(folder / "a.dbf");
  const std::size_t name = table.find("height");
  ASSERT_NE(name, std::string::npos);
  table.replace(name, 6, "H\xF6he\0\0", 6);
  ReadFootprintsOptions options;
  options.height_attribute = "H\xC3\xB6he";
  for (const char code : {'\0', '\x57'}) {  // unstated, ANSI
    table[29] = code;
    write_text(folder / "a.dbf", table);
    EXPECT_EQ(read_footprints(folder / "a.shp", options).features.at(0).height, 7) << int{code};
  }
}

TEST(Vector, CurvesBecomeChords) {
  const TemporaryFolder folder;
  const FootprintsInput input = read_footprints(
      write_text(folder / "curve.csv",
                 "id,WKT\n1,\"CURVEPOLYGON(CIRCULARSTRING(0 0,2 0,4 0,2 -3,0 0))\"\n"
                 "2,\"CURVEPOLYGON(CIRCULARSTRING(10 0,12 2,14 0,12 -2,10 0))\"\n"));
  ASSERT_EQ(input.features.size(), 2U);
  // A circle of radius 2 in chords of 4 degrees.
  EXPECT_EQ(input.features[1].polygon.outer.size(), 90U);
  EXPECT_NEAR(area(input.features[1].polygon), 90 * 2 * std::sin(4 * std::acos(-1.0) / 180), 1e-9);
}

TEST(Vector, LatitudeFirstDataIsTurnedEastFirst) {
  const TemporaryFolder folder;
  const fs::path path = write_text(folder / "a.gml", R"(<?xml version="1.0"?>
<c:FeatureCollection xmlns:c="http://ogr.maptools.org/" xmlns:gml="http://www.opengis.net/gml/3.2">
<c:featureMember><c:a gml:id="a.0"><c:geometryProperty>
<gml:Polygon gml:id="g" srsName="urn:ogc:def:crs:EPSG::4326"><gml:exterior><gml:LinearRing>
<gml:posList>52 4 52 5 53 5 52 4</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
</c:geometryProperty></c:a></c:featureMember></c:FeatureCollection>)");
  const Bounds2 expected{4, 52, 5, 53};
  EXPECT_EQ(read_footprints(path).bounds, expected);
  // Some set-ups make GDAL hand the coordinates over as they are.
  ::setenv("GML_INVERT_AXIS_ORDER_IF_LAT_LONG", "NO", 1);
  const FootprintsInput as_is = read_footprints(path);
  ::unsetenv("GML_INVERT_AXIS_ORDER_IF_LAT_LONG");
  EXPECT_EQ(as_is.bounds, expected);
  EXPECT_EQ(as_is.crs, "EPSG:4326");
  EXPECT_EQ(listing(folder.path()), std::set<std::string>{"a.gml"});
}

/// The faces of a house of 10 m x 8 m at (0, 0): its ground looking down, a roof with eaves of half
/// a metre, a tower on that and four walls. `scale`, `swap`: of the coordinates in the plan.
std::string body_of_a_house(double scale, bool swap) {
  const auto face = [&](const std::vector<Point3>& points) {
    std::string text;
    for (std::size_t i = 0; i <= points.size(); ++i) {
      const Point3& p = points[i % points.size()];
      const double x = 5 + scale * p[0], y = 52 + scale * p[1];
      text +=
          fmt::format("{}[{:.9f},{:.9f},{}]", i > 0 ? "," : "", swap ? y : x, swap ? x : y, p[2]);
    }
    return "[[" + text + "]]";
  };
  const auto plate = [&](double low, double right, double top, double z, bool up) {
    std::vector<Point3> points{{low, low, z}, {right, low, z}, {right, top, z}, {low, top, z}};
    if (!up) std::reverse(points.begin(), points.end());
    return face(points);
  };
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    return face({{x0, y0, 0}, {x1, y1, 0}, {x1, y1, 6}, {x0, y0, 6}});
  };
  return fmt::format("[{},{},{},{},{},{},{}]", plate(0, 10, 8, 0, false),
                     plate(-0.5, 10.5, 8.5, 6, true), plate(3, 5, 5, 9, true), wall(0, 0, 10, 0),
                     wall(10, 0, 10, 8), wall(10, 8, 0, 8), wall(0, 8, 0, 0));
}

/// Where the northing comes first, what looks up in the numbers looks down.
TEST(Vector, BodiesWithTheNorthingFirstHaveTheSameFootprint) {
  const auto footprint = [](bool north_first, double unit) {
    const std::string json = R"({"type": "MultiPolygon", "coordinates": )" +
                             body_of_a_house(1 / unit, north_first) + "}";
    OGRGeometryH geometry = OGR_G_CreateGeometryFromJson(json.c_str());
    const FlatGeometry flat = flatten(geometry, {north_first, unit, 1});
    OGR_G_DestroyGeometry(geometry);
    EXPECT_TRUE(flat.is_body);
    EXPECT_EQ(flat.parts.size(), 1U);
    return flat.parts.at(0).polygon;
  };
  const Ring usual = footprint(false, 1).outer;
  for (const double unit : {1.0, 0.3048, 111'000.0}) {
    Ring swapped = footprint(true, unit).outer;
    for (Point2& p : swapped) p = {5 + (p.y - 5) * unit, 52 + (p.x - 52) * unit};
    ASSERT_EQ(swapped.size(), usual.size());
    const auto first = std::min_element(swapped.begin(), swapped.end(), [&](Point2 a, Point2 b) {
      return std::hypot(a.x - usual[0].x, a.y - usual[0].y) <
             std::hypot(b.x - usual[0].x, b.y - usual[0].y);
    });
    std::rotate(swapped.begin(), first, swapped.end());
    for (std::size_t i = 0; i < usual.size(); ++i) {
      EXPECT_NEAR(swapped[i].x, usual[i].x, 1e-3);
      EXPECT_NEAR(swapped[i].y, usual[i].y, 1e-3);
    }
  }
}

/// A face of the ground that is turned, missing or without elevations loses no part of a building.
TEST(Vector, BodiesWithFaultyGroundKeepTheirFootprint) {
  const auto face = [](const std::vector<Point3>& points, const char* z = nullptr) {
    std::string text;
    for (std::size_t i = 0; i <= points.size(); ++i) {
      const Point3& p = points[i % points.size()];
      text += fmt::format("{}{} {} {}", i > 0 ? "," : "", p[0], p[1],
                          z != nullptr ? std::string(z) : fmt::format("{}", p[2]));
    }
    return "((" + text + "))";
  };
  const std::string walls = face({{0, 0, 90}, {10, 0, 90}, {10, 0, 96}, {0, 0, 96}}) + "," +
                            face({{10, 0, 90}, {10, 8, 90}, {10, 8, 96}, {10, 0, 96}}) + "," +
                            face({{10, 8, 90}, {0, 8, 90}, {0, 8, 96}, {10, 8, 96}});
  // The roof, and a soffit under its eaves.
  const std::string roof = face({{0, 0, 96}, {11, 0, 96}, {11, 8, 96}, {0, 8, 96}}) + "," +
                           face({{10, 0, 95.9}, {10, 8, 95.9}, {11, 8, 95.9}, {11, 0, 95.9}});
  const std::vector<Point3> first{{0, 0, 90}, {10, 8, 90}, {10, 0, 90}},
      second{{0, 0, 90}, {0, 8, 90}, {10, 8, 90}}, turned{{0, 0, 90}, {10, 8, 90}, {0, 8, 90}};
  for (const std::string& other :
       {face(second), face(turned), std::string(), face(second, "1e300"), face(turned, "1e300")}) {
    const std::string wkt = "MULTIPOLYGON Z(" + walls + "," + roof + "," + face(first) +
                            (other.empty() ? "" : "," + other) + ")";
    std::string text = wkt;
    char* cursor = text.data();
    OGRGeometryH geometry = nullptr;
    ASSERT_EQ(OGR_G_CreateFromWkt(&cursor, nullptr, &geometry), OGRERR_NONE) << wkt;
    const FlatGeometry flat = flatten(geometry);
    OGR_G_DestroyGeometry(geometry);
    ASSERT_TRUE(flat.is_body) << wkt;
    ASSERT_EQ(flat.parts.size(), 1U) << wkt;
    // Without half of the ground it is the roof that tells, with its eaves.
    EXPECT_NEAR(area(flat.parts[0].polygon), other.empty() ? 88 : 80, 1e-6) << wkt;
  }
}

/// Walls that stand around the ground tell eaves from ground that is missing, however wide they are
/// and whichever way the ground looks.
TEST(Vector, BodiesWithWideEavesKeepTheirGround) {
  const auto face = [](double x0, double y0, double z0, double x1, double y1, double z1) {
    const bool flat = z0 == z1;
    return fmt::format("(({} {} {},{} {} {},{} {} {},{} {} {},{} {} {}))", x0, y0, z0, x1,
                       flat ? y0 : y1, z0, x1, y1, z1, x0, flat ? y1 : y0, z1, x0, y0, z0);
  };
  const std::string roof = face(-3, -3, 9, 13, 11, 9);
  const std::string walls = face(0, 0, 2, 10, 0, 9) + "," + face(10, 0, 2, 10, 8, 9) + "," +
                            face(10, 8, 2, 0, 8, 9) + "," + face(0, 8, 2, 0, 0, 9);
  const std::string up = face(0, 0, 2, 10, 8, 2), down = face(10, 0, 2, 0, 8, 2);
  const std::string part = face(6, 0, 2, 0, 8, 2);
  struct Case {
    std::string faces;
    double area;
  };
  // Some of the walls in triangles.
  const std::string triangles =
      "((0 0 2,10 0 2,10 0 9,0 0 2)),((0 0 2,10 0 9,0 0 9,0 0 2)),"
      "((10 8 2,0 8 2,0 8 9,10 8 2)),((10 8 2,0 8 9,10 8 9,10 8 2))";
  for (const Case& c :
       {Case{down + "," + roof + "," + walls, 80}, Case{roof + "," + walls + "," + up, 80},
        Case{part + "," + roof + "," + walls, 16 * 14},
        Case{down + "," + roof + "," + triangles + "," + face(10, 0, 2, 10, 8, 9) + "," +
                 face(0, 8, 2, 0, 0, 9),
             80}}) {
    std::string text = "MULTIPOLYGON Z(" + c.faces + ")";
    char* cursor = text.data();
    OGRGeometryH geometry = nullptr;
    ASSERT_EQ(OGR_G_CreateFromWkt(&cursor, nullptr, &geometry), OGRERR_NONE) << text;
    const FlatGeometry flat = flatten(geometry);
    OGR_G_DestroyGeometry(geometry);
    ASSERT_EQ(flat.parts.size(), 1U) << text;
    EXPECT_NEAR(area(flat.parts[0].polygon), c.area, 1e-6) << text;
  }
}

/// Slivers, bow-ties and elevations that are none make no body of a city in one feature.
TEST(Vector, SliversAmongFootprintsMakeNoBody) {
  const TemporaryFolder folder;
  const auto ring = [](const std::vector<Point3>& points) {
    std::string text;
    for (std::size_t i = 0; i <= points.size(); ++i) {
      const Point3& p = points[i % points.size()];
      text += fmt::format("{}[{},{},{}]", i > 0 ? "," : "", p[0], p[1], p[2]);
    }
    return "[[" + text + "]]";
  };
  std::string parts;
  const auto add = [&](const std::vector<Point3>& points) {
    parts += (parts.empty() ? "" : ",") + ring(points);
  };
  for (int i = 0; i < 6; ++i) {
    const double x = 20.0 * i;
    if (i % 2 == 0)
      add({{x, 0, 5}, {x + 9, 0, 5}, {x + 9, 9, 6}, {x, 9, 5}});
    else  // the other way round, one with a corner that nobody has measured
      add({{x, 0, i == 1 ? -9999.0 : 5.0}, {x, 9, 5}, {x + 9, 9, 5}, {x + 9, 0, 5}});
    add({{x, 50, 5}, {x + 9, 59, 5}, {x + 9, 50, 5}, {x, 59, 5}});  // crosses itself
    add({{x, 80, 5}, {x + 9, 80, 5}, {x + 4, 80, 5}});              // a sliver
  }
  const FootprintsInput input = read_footprints(write_text(
      folder / "a.geojson",
      fmt::format(R"({{"type": "FeatureCollection", "crs": {{"type": "name", "properties":
            {{"name": "EPSG:28992"}}}}, "features": [{{"type": "Feature", "properties": {{}}, "geometry":
            {{"type": "MultiPolygon", "coordinates": [{}]}}}}]}})",
                  parts)));
  EXPECT_EQ(input.features.size() + input.dropped.size(), 18U);
  EXPECT_GE(input.features.size(), 12U);
}

TEST(Vector, BodiesInSpaceHaveTheirGroundAsFootprint) {
  const TemporaryFolder folder;
  for (const bool degrees : {false, true}) {
    SCOPED_TRACE(degrees);
    const double scale = degrees ? 1e-5 : 1;
    const fs::path path =
        write_text(folder / (degrees ? "degrees.geojson" : "metres.geojson"),
                   fmt::format(
                       R"({{"type": "FeatureCollection", "crs": {{"type": "name", "properties":
            {{"name": "{}"}}}}, "features": [{{"type": "Feature", "properties": {{}}, "geometry":
            {{"type": "MultiPolygon", "coordinates": {}}}}}]}})",
                       degrees ? "OGC:CRS84" : "EPSG:28992", body_of_a_house(scale, false)));
    const FootprintsInput input = read_footprints(path);
    ASSERT_EQ(input.features.size(), 1U);
    EXPECT_TRUE(input.dropped.empty());
    const Polygon& polygon = input.features[0].polygon;
    EXPECT_TRUE(polygon.holes.empty());
    EXPECT_NEAR(std::abs(signed_area(polygon.outer)), 80 * scale * scale, 1e-3 * scale * scale);
    EXPECT_NEAR(bounds(polygon).width(), 10 * scale, 1e-4 * scale);
    const bool told = std::any_of(
        input.warnings.begin(), input.warnings.end(),
        [](const Warning& w) { return w.code == "footprints_from_bodies" && w.count == 1; });
    EXPECT_TRUE(told);
  }
}

/// Parts within a part are yards of it only if what is left around them is as wide as a wing, and
/// they do not lie above it.
TEST(Vector, RoofsAndGroundsAreNoYards) {
  const TemporaryFolder folder;
  const auto square = [](double low, double high, double z, bool left) {
    std::vector<Point2> p{{low, low}, {high, low}, {high, high}, {low, high}};
    if (!left) std::reverse(p.begin(), p.end());
    std::string text;
    for (std::size_t i = 0; i < 5; ++i)
      text += fmt::format("{}[{},{},{}]", i > 0 ? "," : "", p[i % 4].x, p[i % 4].y, z);
    return "[[" + text + "]]";
  };
  const auto parts_of = [&](const std::string& inner) {
    const FootprintsInput input = read_footprints(write_text(
        folder / "a.geojson",
        fmt::format(R"({{"type": "FeatureCollection", "crs": {{"type": "name", "properties":
            {{"name": "EPSG:28992"}}}}, "features": [{{"type": "Feature", "properties": {{}}, "geometry":
            {{"type": "MultiPolygon", "coordinates": [{},{}]}}}}]}})",
                    square(0, 30, 5, true), inner)));
    const std::size_t yards = input.features[0].polygon.holes.size();
    EXPECT_EQ(has_warning(input, "parts_as_yards"), yards > 0);
    return std::pair(input.features.size(), yards);
  };
  using Parts = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(parts_of(square(8, 22, 5, false)), Parts(1, 1));      // a yard
  EXPECT_EQ(parts_of(square(8, 22, 5, true)), Parts(2, 0));       // turned alike
  EXPECT_EQ(parts_of(square(8, 22, 0, false)), Parts(2, 0));      // the ground below
  EXPECT_EQ(parts_of(square(0.5, 29.5, 5, false)), Parts(2, 0));  // eaves
  EXPECT_EQ(parts_of(square(2, 28, 5, false)), Parts(1, 1));
}

TEST(Vector, SeveralPolygonLayersMustBeNamed) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "set");
  const std::vector<Polygon> polygons = {{{{0, 0}, {1, 0}, {1, 1}}, {}}};
  const std::vector<std::string> ids = {"x"};
  write_footprints(folder / "set/houses.shp", polygons, ids, {}, {}, "");
  write_footprints(folder / "set/sheds.shp", polygons, ids, {}, {}, "");
  const std::string message = input_error(folder / "set");
  EXPECT_NE(message.find("houses"), std::string::npos) << message;
  EXPECT_NE(message.find("sheds"), std::string::npos) << message;
  ReadFootprintsOptions options;
  options.layer = "sheds";
  EXPECT_EQ(read_footprints(folder / "set", options).features.size(), 1U);
}

TEST(Vector, LayersAreListedWithWhatTheyHold) {
  const TemporaryFolder folder;
  write_footprints(
      folder / "houses.gpkg",
      std::vector<Polygon>{{{{0, 0}, {1, 0}, {1, 1}}, {}}, {{{3, 0}, {4, 0}, {4, 1}}, {}}},
      std::vector<std::string>{"a", "b"}, std::vector<double>{3, 4}, {}, "EPSG:3006");
  const std::vector<VectorLayer> layers = list_layers(folder / "houses.gpkg");
  ASSERT_EQ(layers.size(), 1U);
  EXPECT_EQ(layers[0].name, read_footprints(folder / "houses.gpkg").layer);
  EXPECT_TRUE(layers[0].holds_polygons);
  EXPECT_EQ(layers[0].features, 2);
  EXPECT_EQ(layers[0].attributes, (std::vector<std::string>{"id", "height"}));
  EXPECT_THROW(list_layers(folder / "nothing.gpkg"), Error);
}

TEST(Vector, ShapefilesWithoutTheirMembersAreReadInPlace) {
  TETROPOLIS_REQUIRE_DATA(delft, "delft_3dfier");
  const TemporaryFolder folder;
  const FootprintsInput whole = read_footprints(delft / "footprints.shp");
  fs::copy_file(delft / "footprints.shp", folder / "Houses.SHP");
  const auto check = [&](const fs::path& path, std::size_t files, const char* crs) {
    const FootprintsInput input = read_footprints(path);
    EXPECT_EQ(input.features.size(), 160U);
    EXPECT_EQ(input.bounds, whole.bounds);
    EXPECT_EQ(input.crs, crs);
    EXPECT_EQ(has_warning(input, "footprints_crs_unknown"), input.crs.empty());
    EXPECT_EQ(listing(folder.path()).size(), files);
  };
  check(folder / "Houses.SHP", 1, "");
  fs::rename(folder / "Houses.SHP", folder / "a.shp");
  check(folder / "a.shp", 1, "");
  fs::copy_file(delft / "footprints.prj", folder / "a.prj");
  check(folder / "a.shp", 2, "EPSG:28992");
  fs::copy_file(delft / "footprints.shx", folder / "a.shx");
  check(folder / "a.shp", 3, "EPSG:28992");
  fs::copy_file(delft / "footprints.dbf", folder / "a.dbf");
  check(folder / "a.shp", 4, "EPSG:28992");
  // An index that differs from what would be made anew is left as it is.
  std::string index = bytes_of(folder / "a.shx");
  fs::permissions(folder / "a.shx", fs::perms::owner_write, fs::perm_options::add);
  index[40] = static_cast<char>(index[40] ^ 1);  // In the box of its header.
  write_text(folder / "a.shx", index);
  check(folder / "a.shp", 4, "EPSG:28992");
  EXPECT_TRUE(bytes_of(folder / "a.shx") == index);
}

/// As PostGIS writes it where there are no attributes.
TEST(Vector, ShapefilesWhoseTableHasNoColumnsAreRead) {
  const TemporaryFolder folder;
  write_footprints(
      folder / "a.shp",
      std::vector<Polygon>{{{{0, 0}, {9, 0}, {9, 9}}, {}}, {{{20, 0}, {29, 0}, {29, 9}}, {}}},
      std::vector<std::string>{"x", "y"}, {}, {}, "EPSG:28992");
  std::string table = bytes_of(folder / "a.dbf").substr(0, 32) + '\x0D';
  table.replace(4, 8, std::string("\0\0\0\0\x21\0\1\0", 8));  // records, lengths of head and record
  write_text(folder / "a.dbf", table);
  const std::set<std::string> before = listing(folder.path());
  const FootprintsInput input = read_footprints(folder / "a.shp");
  ASSERT_EQ(input.features.size(), 2U);
  EXPECT_EQ(input.features[1].source_id, "1");
  EXPECT_EQ(input.crs, "EPSG:28992");
  EXPECT_EQ(listing(folder.path()), before);
}

TEST(Vector, ArchivesAreReadInPlace) {
  const TemporaryFolder folder;
  const std::vector<Polygon> polygons = {{{{0, 0}, {9, 0}, {9, 9}}, {}}};
  const std::vector<std::string> ids = {"x"};
  fs::create_directories(folder / "deep/er");
  write_footprints(folder / "deep/er/houses.shp", polygons, ids, {}, {}, "EPSG:28992");
  const auto archive = [&](const std::string& name, const std::string& members) {
    const std::string command = "cd '" + folder.path().string() + "' && python3 -m zipfile -c " +
                                name + " " + members + " 2>/dev/null";
    return std::system(command.c_str()) == 0;
  };
  if (!archive("one.zip", "deep")) GTEST_SKIP() << "needs python3";
  const std::set<std::string> before = listing(folder.path());
  const FootprintsInput direct = read_footprints(folder / "deep/er/houses.shp");
  const FootprintsInput zipped = read_footprints(folder / "one.zip");
  ASSERT_EQ(zipped.features.size(), 1U);
  EXPECT_EQ(zipped.bounds, direct.bounds);
  EXPECT_EQ(zipped.crs, "EPSG:28992");
  EXPECT_EQ(listing(folder.path()), before);

  write_footprints(folder / "sheds.shp", polygons, ids, {}, {}, "");
  ASSERT_TRUE(archive("two.zip", "deep sheds.shp sheds.shx sheds.dbf"));
  const std::string two = input_error(folder / "two.zip");
  EXPECT_NE(two.find("sheds.shp"), std::string::npos) << two;
  EXPECT_NE(two.find("deep/er/houses.shp"), std::string::npos) << two;
  ASSERT_TRUE(archive("none.zip", "sheds.dbf"));
  EXPECT_NE(input_error(folder / "none.zip").find("no vector file"), std::string::npos);
  write_text(folder / "cut.zip", bytes_of(folder / "one.zip").substr(0, 200));
  input_error(folder / "cut.zip");

  // What may be features or describe them, alone and beside what is.
  write_text(folder / "plain.csv", "id,WKT\nx,\"POLYGON((0 0,9 0,9 9,0 0))\"\n");
  write_text(folder / "metadata.json", "{}");
  ASSERT_TRUE(archive("csv.zip", "plain.csv"));
  EXPECT_EQ(read_footprints(folder / "csv.zip").features.size(), 1U);
  ASSERT_TRUE(archive("described.zip", "deep metadata.json"));
  EXPECT_EQ(read_footprints(folder / "described.zip").features.size(), 1U);
  write_footprints(folder / "houses.json", polygons, ids, {}, {}, "EPSG:28992");
  write_text(folder / "metadata.xml", "<a/>");
  ASSERT_TRUE(archive("json.zip", "houses.json metadata.xml"));
  EXPECT_EQ(read_footprints(folder / "json.zip").features.size(), 1U);
}

TEST(Vector, GeodatabasesInArchives) {
  const TemporaryFolder folder;
  const fs::path shp = folder / "a.shp";
  write_footprints(shp, std::vector<Polygon>{{{{0, 0}, {9, 0}, {9, 9}}, {}}},
                   std::vector<std::string>{"x"}, {}, {}, "EPSG:28992");
  const auto shell = [&](const std::string& command) {
    return std::system(
        ("cd '" + folder.path().string() + "' && " + command + " >/dev/null 2>&1").c_str());
  };
  ASSERT_EQ(shell("ogr2ogr -f OpenFileGDB houses.gdb a.shp && "
                  "python3 -m zipfile -c a.gdb.zip houses.gdb"),
            0);
  const FootprintsInput input = read_footprints(folder / "a.gdb.zip");
  EXPECT_EQ(input.features.size(), 1U);
  EXPECT_EQ(input.crs, "EPSG:28992");
  // A folder that is one, or holds them.
  fs::rename(folder / "houses.gdb", folder / "B.GDB");
  ASSERT_EQ(shell("ogr2ogr -f OpenFileGDB more.gdb a.shp"), 0);
  const std::string whole = folder.path().string(), one = whole + "/B.GDB/";
  EXPECT_EQ(expand_paths(std::vector<std::string>{one}, kVectorFiles).size(), 1U);
  EXPECT_EQ(expand_paths(std::vector<std::string>{one, whole + "/more.gdb"}, kVectorFiles).size(),
            2U);
  EXPECT_EQ(expand_paths(std::vector<std::string>{whole}, kVectorFiles).size(), 3U);
  EXPECT_EQ(read_footprints(folder / "B.GDB").features.size(), 1U);
}

TEST(Vector, FoldersOfTilesMayHoldCityModels) {
  const TemporaryFolder folder;
  for (const char* name : {"1.city.json", "2.city.jsonl", "3.gml", "notes.json"})
    write_text(folder / name, "{}");
  const auto paths = expand_paths(std::vector<std::string>{folder.path().string()}, kVectorFiles);
  EXPECT_EQ(paths, (std::vector<fs::path>{folder / "1.city.json", folder / "2.city.jsonl",
                                          folder / "3.gml"}));
}

/// `out geom` of the Overpass API: members of relations have their places, and no way is a file's.
TEST(Vector, OverpassMayGiveThePlacesOfMembersAlone) {
  const TemporaryFolder folder;
  const auto json = [](const char* role, int id, const std::vector<std::array<double, 2>>& places) {
    std::string text = fmt::format(R"({{"type":"way","ref":{},"role":"{}","geometry":[)", id, role);
    for (const auto& [lon, lat] : places)
      text += fmt::format(R"({}{{"lat":{},"lon":{}}})", text.back() == '[' ? "" : ",", lat, lon);
    return text + "]}";
  };
  const auto xml = [](const char* role, int id, const std::vector<std::array<double, 2>>& places) {
    std::string text = fmt::format("<member type='way' ref='{}' role='{}'>", id, role);
    for (const auto& [lon, lat] : places) text += fmt::format("<nd lat='{}' lon='{}'/>", lat, lon);
    return text + "</member>";
  };
  const std::vector<std::array<double, 2>> west{{7.001, 50}, {7, 50}, {7, 50.001}, {7.001, 50.001}},
      east{{7.001, 50.001}, {7.002, 50.001}, {7.002, 50}, {7.001, 50}},
      yard{{7.0005, 50.0004}, {7.001, 50.0004}, {7.001, 50.0006}, {7.0005, 50.0004}};
  write_text(folder / "a.json", R"({"elements":[{"type":"relation","id":5,"members":[)" +
                                    json("outer", 1, west) + "," + json("outer", 2, east) + "," +
                                    json("inner", 3, yard) +
                                    R"(],"tags":{"type":"multipolygon","building":"yes"}}]})");
  write_text(folder / "a.osm",
             "<osm version='0.6'><relation id='5'>" + xml("outer", 1, west) +
                 xml("outer", 2, east) + xml("inner", 3, yard) +
                 "<tag k='type' v='multipolygon'/><tag k='building' v='yes'/></relation></osm>");
  for (const char* name : {"a.json", "a.osm"}) {
    const FootprintsInput input = read_footprints(folder / name);
    ASSERT_EQ(input.features.size(), 1U) << name;
    EXPECT_EQ(input.features[0].source_id, "relation/5");
    EXPECT_EQ(input.features[0].polygon.outer.size(), 6U);
    EXPECT_EQ(input.features[0].polygon.holes.size(), 1U);
    EXPECT_TRUE(input.dropped.empty());
  }
  // A way that leaves the box of the query has no place there.
  write_text(folder / "b.json",
             R"({"elements":[{"type":"relation","id":5,"members":[{"type":"way","ref":1,)"
             R"("role":"outer","geometry":[{"lat":50,"lon":7},null,{"lat":50,"lon":7.1}]}],)"
             R"("tags":{"type":"multipolygon","building":"yes"}}]})");
  const FootprintsInput cut = read_footprints(folder / "b.json");
  EXPECT_TRUE(cut.features.empty());
  EXPECT_EQ(cut.dropped.size(), 1U);
}

TEST(Vector, ConditionsOnTextTellHowToCompareNumbers) {
  const TemporaryFolder folder;
  const fs::path path = write_text(
      folder / "a.csv",
      "confidence,WKT\n0.9,\"POLYGON((0 0,9 0,9 9,0 0))\"\n0.5,\"POLYGON((0 0,9 0,9 9,0 0))\"\n");
  ReadFootprintsOptions options;
  options.where = "confidence > 0.7";
  EXPECT_NE(input_error(path, options).find("CAST(height AS float)"), std::string::npos);
  options.where = "CAST(confidence AS float) > 0.7";
  EXPECT_EQ(read_footprints(path, options).features.size(), 1U);
}

/// GDAL would read them, but for some buildings and heights.
TEST(Vector, PackedModelsAreToBeUnpacked) {
  const TemporaryFolder folder;
  write_text(folder / "a.gml", "<CityModel xmlns=\"http://www.opengis.net/citygml/2.0\"/>");
  write_text(folder / "b.json", R"({"type":"CityJSON","version":"1.1","CityObjects":{}})");
  write_text(folder / "c.osm", "<?xml version='1.0'?><osm version='0.6'/>");
  for (const auto& [name, what] :
       {std::pair{"a.gml", "city model"}, {"b.json", "city model"}, {"c.osm", "OpenStreetMap"}}) {
    const std::string in_folder = "cd '" + folder.path().string() + "' && ";
    ASSERT_EQ(std::system((in_folder + "python3 -m zipfile -c p.zip " + name).c_str()), 0);
    const std::string said = input_error(folder / "p.zip");
    EXPECT_NE(said.find(what), std::string::npos) << said;
    EXPECT_NE(said.find("unpack it"), std::string::npos) << said;
  }
  ASSERT_EQ(std::system(("gzip '" + (folder / "a.gml").string() + "'").c_str()), 0);
  EXPECT_NE(input_error(folder / "a.gml.gz").find("unpack it"), std::string::npos);
}

TEST(Vector, PackedFilesAreReadInPlace) {
  const TemporaryFolder folder;
  write_footprints(folder / "a.geojson", std::vector<Polygon>{{{{0, 0}, {9, 0}, {9, 9}}, {}}},
                   std::vector<std::string>{"x"}, {}, {}, "EPSG:28992");
  write_text(folder / "b.csv", "id,geometry\nx,\"POLYGON((0 0,9 0,9 9,0 0))\"\n");
  // Lines of GeoJSON by the name of a table, as Microsoft has them.
  write_text(
      folder / "c.csv",
      R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[3,8],[4,8],[4,9],[3,8]]]}})"
      "\n");
  for (const char* name : {"a.geojson", "b.csv", "c.csv"}) {
    ASSERT_EQ(std::system(fmt::format("gzip -k '{}'", (folder / name).string()).c_str()), 0);
    EXPECT_EQ(read_footprints(folder / (std::string(name) + ".gz")).features.size(), 1U) << name;
  }
  EXPECT_EQ(listing(folder.path()), (std::set<std::string>{"a.geojson", "a.geojson.gz", "b.csv",
                                                           "b.csv.gz", "c.csv", "c.csv.gz"}));
}

TEST(Vector, GeometriesThatCannotBeReadAreThoseOfTheirFeatures) {
  const TemporaryFolder folder;
  const auto feature = [](int id, const std::string& geometry) {
    return fmt::format(R"({{"type":"Feature","properties":{{"id":{}}},"geometry":{}}})", id,
                       geometry);
  };
  const auto polygon = [](const std::string& corner) {
    return R"({"type":"Polygon","coordinates":[[[0,0],[9,0],)" + corner + ",[0,0]]]}";
  };
  const std::string sound = polygon("[9,9]");
  for (const std::string& broken :
       {polygon(R"(["9",9])"), polygon("[true,9]"), polygon(R"([9,9,"high"])"), polygon("[null,9]"),
        polygon("null"), polygon("[9]"), "[" + sound + "]", std::string(R"({"type":"Polygon"})"),
        std::string(R"({"type":"Polygon","coordinates":null})"),
        std::string(R"({"type":"MultiPolygon","coordinates":[[[[0,0],["a",0],[9,9],[0,0]]]]})"),
        std::string(R"({"type":"GeometryCollection"})"), std::string("{}")}) {
    SCOPED_TRACE(broken);
    const std::array features{feature(1, sound), feature(2, broken), feature(3, sound)};
    const fs::path collection = write_text(
        folder / "a.geojson", fmt::format(R"({{"type":"FeatureCollection","features":[{}]}})",
                                          fmt::join(features, ",\n")));
    const fs::path lines =
        write_text(folder / "b.geojsonl", fmt::format("{}\n", fmt::join(features, "\n")));
    for (const fs::path& path : {collection, lines}) {
      SCOPED_TRACE(path.filename());
      ReadFootprintsOptions options;
      options.id_attribute = "id";
      const FootprintsInput input = read_footprints(path, options);
      ASSERT_EQ(input.features.size(), 2U);
      EXPECT_EQ(input.features[0].source_id, "1");
      EXPECT_EQ(input.features[1].source_id, "3");
      ASSERT_EQ(input.dropped.size(), 1U);
      EXPECT_EQ(input.dropped[0].source_id, "2");
      EXPECT_NE(input.dropped[0].reason.find("geometry"), std::string::npos);
    }
  }
}

/// Three features "a.0" to "a.2" of GML, of which the middle one has these corners.
std::string gml(const std::string& corners, const std::string& root = "",
                const std::string& system = "urn:ogc:def:crs:EPSG::28992") {
  std::string members;
  for (const auto& [k, text] : {std::pair{0, std::string("0 0 9 0 9 9 0 0")}, std::pair{1, corners},
                                std::pair{2, std::string("20 0 29 0 29 9 20 0")}})
    members += fmt::format(
        "<gml:featureMember><a gml:id=\"a.{}\"><name>n{}</name><g><gml:Polygon srsName=\"{}\">"
        "<gml:exterior><gml:LinearRing><gml:posList>{}</gml:posList></gml:LinearRing>"
        "</gml:exterior></gml:Polygon></g></a></gml:featureMember>\n",
        k, k, system, text);
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<FeatureCollection xmlns:gml=\"http://www.opengis.net/gml/3.2\" "
      "{}>\n"
      "{}</FeatureCollection>\n",
      root, members);
}

TEST(Vector, OfGmlOnlyTheFeatureIsLostThatCannotBeRead) {
  const TemporaryFolder folder;
  for (const char* corners : {"10 0 19 0 19 9 10", "10 0 19", "10"}) {
    SCOPED_TRACE(corners);
    const fs::path path = write_text(folder / "a.gml", gml(corners));
    const FootprintsInput input = read_footprints(path);
    EXPECT_EQ(input.features_read, 3);
    ASSERT_EQ(input.features.size(), 2U);
    EXPECT_EQ(input.features[1].polygon.outer.front().x, 20);
    ASSERT_EQ(input.dropped.size(), 1U);
    EXPECT_EQ(input.dropped[0].source_id, "1");
    EXPECT_NE(input.dropped[0].reason.find("a.1"), std::string::npos) << input.dropped[0].reason;
  }
  const std::string whole = gml("10 0 19 0 19 9 10 0");
  const fs::path sound = write_text(folder / "b.gml", whole);
  EXPECT_EQ(read_footprints(sound).features.size(), 3U);
  for (const std::size_t cut : {std::size_t{30}, whole.size() / 2}) {
    const fs::path path = write_text(folder / "c.gml", whole.substr(0, whole.size() - cut));
    EXPECT_NE(input_error(path).find("cut or broken"), std::string::npos);
  }
}

/// What is wrong with a file is told even between and after features that are broken.
TEST(Vector, BrokenGeometriesDoNotHideThatAFileIsCut) {
  const TemporaryFolder folder;
  const std::string broken = gml("10 0 19 0 19 9 10");
  // With a schema beside it the file is read once only.
  write_text(folder / "a.xsd",
             "<?xml version=\"1.0\"?>\n<xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\" "
             "xmlns:gml=\"http://www.opengis.net/gml/3.2\"><xs:element name=\"a\" "
             "substitutionGroup=\"gml:AbstractFeature\"><xs:complexType><xs:complexContent>"
             "<xs:extension base=\"gml:AbstractFeatureType\"><xs:sequence>"
             "<xs:element name=\"g\" type=\"gml:SurfacePropertyType\"/>"
             "<xs:element name=\"name\" type=\"xs:string\"/></xs:sequence></xs:extension>"
             "</xs:complexContent></xs:complexType></xs:element></xs:schema>\n");
  EXPECT_EQ(read_footprints(write_text(folder / "a.gml", broken)).features.size(), 2U);
  const std::size_t last = broken.find("a.2");
  for (const std::size_t size : {last, broken.find("posList", last), broken.size() - 20})
    EXPECT_NE(
        input_error(write_text(folder / "a.gml", broken.substr(0, size))).find("cut or broken"),
        std::string::npos)
        << size;
  const fs::path packed = write_text(folder / "b.gml", broken);
  ASSERT_EQ(std::system(fmt::format("gzip '{}'", packed.string()).c_str()), 0);
  std::string bytes = bytes_of(folder / "b.gml.gz");
  EXPECT_EQ(read_footprints(folder / "b.gml.gz").features.size(), 2U);
  bytes[bytes.size() - 6] = static_cast<char>(bytes[bytes.size() - 6] + 1);  // of the check sum
  input_error(write_text(folder / "c.gml.gz", bytes));
  const std::string line = R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon")";
  const std::string good = line + R"(,"coordinates":[[[0,0],[9,0],[9,9],[0,0]]]}})" + "\n";
  const std::string odd = line + R"(,"coordinates":[[[0,0],["a",0],[9,9],[0,0]]]}})" + "\n";
  EXPECT_EQ(read_footprints(write_text(folder / "d.geojsonl", good + odd + good)).features.size(),
            2U);
  EXPECT_NE(input_error(write_text(folder / "d.geojsonl", good + odd + line + "\n" + odd + good))
                .find("cut or broken"),
            std::string::npos);
}

TEST(Vector, AnUnknownSystemDoesNotMatterWhereAnotherIsGiven) {
  const TemporaryFolder folder;
  const fs::path path =
      write_text(folder / "a.gml", gml("10 0 19 0 19 9 10 0", "", "urn:ogc:def:crs:EPSG::99999"));
  EXPECT_NE(input_error(path).find("footprints_crs"), std::string::npos);
  ReadFootprintsOptions options;
  options.source_crs = "EPSG:28992";
  const FootprintsInput input = read_footprints(path, options);
  EXPECT_EQ(input.features.size(), 3U);
  EXPECT_EQ(input.crs, "EPSG:28992");
}

TEST(Vector, PagesOfServersAreToldAsSuch) {
  const TemporaryFolder folder;
  const auto json = [](const std::string& members) {
    return R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},)"
           R"("geometry":{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,0]]]}}])" +
           members + "}";
  };
  const std::string corners = "10 0 19 0 19 9 10 0";
  struct Answer {
    const char* name;
    std::string text;
    const char* told;  ///< Null: nothing is missing.
  };
  const std::vector<Answer> answers{
      {"a.geojson", json(R"(,"exceededTransferLimit":true)"), "exceededTransferLimit"},
      {"b.geojson", json(R"(,"properties": {"exceededTransferLimit" : true})"),
       "exceededTransferLimit"},
      {"c.geojson", json(R"(,"exceededTransferLimit":false)"), nullptr},
      {"d.geojson", json(R"(,"numberMatched":1000,"numberReturned":1)"), "1 features of 1000"},
      {"e.geojson", json(R"(,"numberMatched":1,"numberReturned":1,"links":[{"rel":"self"}])"),
       nullptr},
      {"f.geojson", json(R"(,"links":[{"rel":"self"},{"href":"x","rel": "next"}])"),
       "links to the next"},
      {"g.geojson", json("," + std::string(200000, ' ') + R"("exceededTransferLimit":true)"),
       "exceededTransferLimit"},
      {"h.json",
       R"({"geometryType":"esriGeometryPolygon","fields":[{"name":"a","type":"esriFieldTypeString"}],)"
       R"("features":[{"attributes":{"a":"x"},"geometry":{"rings":[[[0,0],[0,9],[9,9],[0,0]]]}}],)"
       R"("exceededTransferLimit":true})",
       "exceededTransferLimit"},
      {"i.gml", gml(corners, "numberMatched='1000' numberReturned=\"3\""), "3 features of 1000"},
      {"j.gml", gml(corners, "numberMatched='unknown' numberReturned='3'"), nullptr},
  };
  for (const Answer& answer : answers) {
    SCOPED_TRACE(answer.name);
    const FootprintsInput input = read_footprints(write_text(folder / answer.name, answer.text));
    EXPECT_FALSE(input.features.empty());
    std::string told;
    for (const Warning& warning : input.warnings)
      if (warning.code == "footprints_fewer") told = warning.message;
    if (answer.told == nullptr)
      EXPECT_EQ(told, "");
    else
      EXPECT_NE(told.find(answer.told), std::string::npos) << told;
  }
}

TEST(Vector, OfOpenStreetMapOnlyBuildingsAreRead) {
  const TemporaryFolder folder;
  std::string nodes, ways;
  const auto add = [&](int id, const std::string& key, const std::string& value) {
    std::string refs;
    for (const auto& [dx, dy] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{1, 1}}) {
      const int node = 10 * id + 2 * dx + dy;
      nodes += fmt::format("<node id=\"{}\" version=\"1\" lat=\"{}\" lon=\"{}\"/>\n", node,
                           50 + 0.001 * dy, 7 + 0.01 * id + 0.001 * dx);
      refs += fmt::format("<nd ref=\"{}\"/>", node);
    }
    refs += fmt::format("<nd ref=\"{}\"/>", 10 * id);
    ways += fmt::format(
        "<way id=\"{}\" version=\"1\">{}<tag k=\"{}\" v=\"{}\"/><tag k=\"note\" "
        "v=\"say &quot;height&quot;=&gt;&quot;99&quot;\"/><tag k=\"height\" v=\"{} m\"/></way>\n",
        id, refs, key, value, 10 + id);
  };
  add(7, "building", "yes");  // JOSM does not sort what it saves
  add(2, "landuse", "residential");
  add(3, "building", "house");
  add(4, "natural", "water");
  add(5, "building", "no");
  // More than GDAL keeps of a layer that nobody reads.
  for (int id = 1000; id < 111000; ++id)
    nodes += fmt::format(
        "<node id=\"{}\" version=\"1\" lat=\"50\" lon=\"7\"><tag k=\"name\" v=\"x\"/></node>\n",
        id);
  const fs::path path =
      write_text(folder / "a.osm",
                 "<?xml version=\"1.0\"?>\n<osm version=\"0.6\">\n" + nodes + ways + "</osm>\n");
  ReadFootprintsOptions options;
  options.id_attribute = "osm_way_id";
  options.height_attribute = "height";
  const FootprintsInput input = read_footprints(path, options);
  ASSERT_EQ(input.features.size(), 2U);
  std::set<std::string> ids;
  for (const Footprint& feature : input.features) {
    ids.insert(feature.source_id);
    EXPECT_EQ(feature.height, 10 + std::stod(feature.source_id));
  }
  EXPECT_EQ(ids, (std::set<std::string>{"3", "7"}));
  EXPECT_EQ(input.features_read, 2);
  // As the server calls it.
  fs::copy_file(path, folder / "map");
  EXPECT_EQ(read_footprints(folder / "map", options).features.size(), 2U);
}

TEST(Vector, AttributesOfSeveralFilesStayWithTheirFeatures) {
  const auto file = [](int features, int first, bool has_names) {
    std::string text = R"({"type":"FeatureCollection","features":[)";
    for (int i = 0; i < features; ++i)
      text += fmt::format(
          R"({}{{"type":"Feature","properties":{{{}}},"geometry":{{"type":"Polygon","coordinates":[[[{},0],[{},0],[{},1],[{},0]]]}}}})",
          i == 0 ? "" : ",", has_names ? fmt::format(R"("name":"n{}")", first + i) : "", first + i,
          first + i + 1, first + i + 1, first + i);
    return text + "]}";
  };
  const TemporaryFolder folder;
  const fs::path bare = write_text(folder / "bare.geojson", file(3, 0, false));
  const fs::path named = write_text(folder / "named.geojson", file(2, 10, true));
  ReadFootprintsOptions options;
  options.attributes = true;
  for (const std::vector<fs::path>& paths : {std::vector{bare, named}, {named, bare}}) {
    std::vector<FootprintsInput> inputs;
    for (const fs::path& path : paths) inputs.push_back(read_footprints(path, options));
    const FootprintsInput all = merge_footprints(std::move(inputs), paths);
    ASSERT_EQ(all.attributes.size(), 1U);
    const auto& names = std::get<std::vector<std::string>>(all.attributes[0].values);
    ASSERT_EQ(all.features.size(), 5U);
    for (const Footprint& feature : all.features) {
      const bool is_bare = feature.source_id.starts_with("bare");
      EXPECT_EQ(feature.feature < 0, is_bare) << feature.source_id;
      if (is_bare) continue;
      ASSERT_LT(static_cast<std::size_t>(feature.feature), names.size());
      EXPECT_EQ(names[static_cast<std::size_t>(feature.feature)],
                fmt::format("n{}", feature.polygon.outer[0].x));
    }
  }
}

TEST(Vector, ColumnsThatNobodyAskedForMayHoldAnything) {
  const TemporaryFolder folder;
  constexpr const char* kPolygon = R"("type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,0]]])";
  const fs::path path = write_text(
      folder / "a.geojson",
      fmt::format(R"({{"type":"FeatureCollection","features":[{{"type":"Feature","properties":)"
                  R"({{"building":"yes","levels":true,"height":[1,2]}},"geometry":{{{}}}}}]}})",
                  kPolygon));
  const FootprintsInput input = read_footprints(path);
  ASSERT_EQ(input.features.size(), 1U);
  EXPECT_TRUE(std::isnan(input.features[0].height));
  ReadFootprintsOptions asked;
  asked.floors_attribute = "levels";
  EXPECT_NE(input_error(path, asked).find("Boolean"), std::string::npos);
}

TEST(Vector, WaysThatTouchTheOutlineOfARelationAreBuildingsOfTheirOwn) {
  for (const bool from_common_node : {true, false}) {
    const TemporaryFolder folder;
    std::string text = "<?xml version=\"1.0\"?>\n<osm version=\"0.6\">\n";
    const double places[][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 1}, {3, 1}};
    for (int i = 0; i < 6; ++i)
      text += fmt::format("<node id=\"{}\" lat=\"{}\" lon=\"{}\"/>\n", i + 1,
                          50 + 0.001 * places[i][1], 7 + 0.001 * places[i][0]);
    const char* const inner = from_common_node ? "<nd ref=\"1\"/><nd ref=\"6\"/><nd ref=\"5\"/>"
                                                 "<nd ref=\"1\"/>"
                                               : "<nd ref=\"6\"/><nd ref=\"5\"/><nd ref=\"1\"/>"
                                                 "<nd ref=\"6\"/>";
    text += fmt::format(
        "<way id=\"10\"><nd ref=\"1\"/><nd ref=\"2\"/><nd ref=\"3\"/><nd ref=\"4\"/>"
        "<nd ref=\"1\"/></way>\n<way id=\"11\">{}<tag k=\"building\" v=\"yes\"/></way>\n"
        "<relation id=\"20\"><member type=\"way\" ref=\"10\" role=\"outer\"/><member type=\"way\" "
        "ref=\"11\" role=\"inner\"/><tag k=\"type\" v=\"multipolygon\"/><tag k=\"building\" "
        "v=\"yes\"/></relation>\n</osm>\n",
        inner);
    const FootprintsInput input = read_footprints(write_text(folder / "a.osm", text));
    std::set<std::string> ids;
    for (const Footprint& feature : input.features) ids.insert(feature.source_id);
    EXPECT_EQ(ids, (std::set<std::string>{"relation/20", "way/11"})) << from_common_node;
  }
}

TEST(Vector, BuildingsThatOpenStreetMapExtractsLackPartsOfAreAccountedFor) {
  const TemporaryFolder folder;
  std::string nodes;
  for (int k = 0; k < 40; ++k) {
    const double dx = k % 4 == 1 || k % 4 == 2 ? 0.001 : 0, dy = k % 4 >= 2 ? 0.001 : 0;
    nodes += fmt::format("<node id=\"{}\" lat=\"{}\" lon=\"{}\"/>\n", 100 + k, 50 + dy,
                         7 + 0.01 * (k / 4) + dx);
  }
  const auto way = [](int id, const std::vector<int>& refs, const char* tags) {
    std::string text = fmt::format("<way id='{}' version=\"1\">", id);
    for (const int ref : refs) text += fmt::format("<nd ref=\"{}\"/>", ref);
    return text + tags + "</way>\n";
  };
  const auto relation = [](int id, const std::vector<int>& members, const char* tags) {
    std::string text = fmt::format("<relation id=\"{}\" version=\"1\">", id);
    for (std::size_t k = 0; k < members.size(); ++k)
      text += fmt::format("<member type=\"way\" ref=\"{}\" role=\"{}\"/>", members[k],
                          k == 0 ? "outer" : "inner");
    return text + tags + "</relation>\n";
  };
  constexpr const char* kHouse = "<tag k=\"building\" v=\"yes\"/>";
  constexpr const char* kArea =
      "<tag k=\"building\" v=\"yes\"/><tag k=\"type\" v=\"multipolygon\"/>";
  const std::string text =
      "<?xml version=\"1.0\"?>\n<!-- it's <way id=\"9\"> > <tag k=\"building\" v=\"yes\"/></way> "
      "-->\n"
      "<osm version=\"0.6\">\n" +
      nodes + way(1, {100, 101, 102, 103, 100}, kHouse) +
      way(2, {104, 105, 106, 107}, kHouse) +                                // not closed
      way(3, {108, 109, 999, 111, 108}, kHouse) +                           // lacks a corner
      way(4, {990, 991, 992, 990}, kHouse) +                                // lacks all
      way(5, {112, 113, 114, 115, 112}, "<tag k=\"note\" v=\"a > b\"/>") +  // of the relations
      way(4, {990, 991, 992, 990}, kHouse) +                                // of a merged extract
      way(6, {116, 117, 118, 119, 116}, "<tag k=\"building\" v=\"No\"/>") +
      way(7, {120, 121, 122, 123, 120}, "<tag k=\"landuse\" v=\"grass\"/>") +
      way(8, {124, 125, 126, 127}, "<tag k=\"barrier\" v=\"wall\"/>") +
      relation(20, {5, 999}, kArea) + relation(21, {7}, kArea) +
      relation(22, {7}, "<tag k=\"building\" v=\"yes\"/><tag k=\"type\" v=\"route\"/>") +
      relation(23, {7}, "<tag k=\"building\" v=\"yes\"/><tag k=\"type\" v=\"building\"/>") +
      "<way id=\"10\" action=\"delete\"><nd ref=\"100\"/>" + kHouse + "</way>\n</osm>\n";
  const FootprintsInput input = read_footprints(write_text(folder / "a.osm", text));
  std::map<std::string, std::string> lost;
  for (const Dropped& dropped : input.dropped) lost[dropped.source_id] = dropped.reason;
  EXPECT_EQ(lost, (std::map<std::string, std::string>{
                      {"way/2", "a way that is not closed"},
                      {"way/4", "the file lacks 4 of its 4 nodes"},
                      {"relation/20", "the file lacks 1 of its 2 ways"},
                      {"relation/22", "a relation of type 'route', not an area"}}));
  EXPECT_EQ(input.features.size(), 4U);  // ways 1 and 3, relations 21 and 23
  EXPECT_EQ(input.features_read, 8);
  const auto told = std::find_if(input.warnings.begin(), input.warnings.end(),
                                 [](const Warning& w) { return w.code == "osm_nodes_missing"; });
  ASSERT_NE(told, input.warnings.end());
  EXPECT_EQ(told->count, 1);
  EXPECT_NE(told->message.find("way/3"), std::string::npos) << told->message;
}

/// A few broken coordinates do not make the others metres; metres are none of degrees even where
/// many would do.
TEST(Vector, BrokenFeaturesAreDroppedFromFilesInDegrees) {
  const TemporaryFolder folder;
  const auto feature = [](double x, double y, double size) {
    return fmt::format(
        R"({{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[[[{},{}],[{},{}],[{},{}],[{},{}]]]}}}})",
        x, y, x + size, y, x + size, y + size, x, y);
  };
  const auto read = [&](const std::vector<std::string>& features) {
    ReadFootprintsOptions options;
    options.target_crs = "EPSG:32631";
    return read_footprints(
        write_text(folder / "a.geojson",
                   fmt::format(R"({{"type":"FeatureCollection","features":[{}]}})",
                               fmt::join(features, ","))),
        options);
  };
  std::vector<std::string> degrees;
  for (int i = 0; i < 7; ++i) degrees.push_back(feature(4 + 0.001 * i, 52, 0.0005));
  for (const std::string& broken :
       {feature(4, 95, 0.1), feature(4e5, 5.8e6, 10), feature(4, 52, 1e300)}) {
    std::vector<std::string> features = degrees;
    features.insert(features.begin() + 3, broken);
    const FootprintsInput input = read(features);
    EXPECT_EQ(input.features.size(), 7U) << broken;
    ASSERT_EQ(input.dropped.size(), 1U) << broken;
    EXPECT_EQ(input.dropped[0].source_id, "3");
    EXPECT_FALSE(has_warning(input, "footprints_crs_implausible"));
  }
  std::vector<std::string> metres;
  for (int i = 0; i < 10; ++i) metres.push_back(feature(20 * i, 15, 10));
  EXPECT_TRUE(has_warning(read(metres), "footprints_crs_implausible"));
  EXPECT_TRUE(
      has_warning(read({feature(5, 5, 10), feature(200, 5, 10)}), "footprints_crs_implausible"));
}

/// Twenty triangles in another format, converted by ogr2ogr (of gdal-bin, which install-deps
/// installs).
fs::path converted(const TemporaryFolder& folder, const std::string& format,
                   const std::string& extension) {
  const std::vector<Polygon> polygons(20, Polygon{{{0, 0}, {9, 0}, {9, 9}}, {}});
  std::vector<std::string> ids;
  for (int i = 0; i < 20; ++i) ids.push_back(std::to_string(i));
  const fs::path from = folder / "a.geojson", to = folder / ("whole." + extension);
  write_footprints(from, polygons, ids, {}, {}, "EPSG:28992");
  EXPECT_EQ(std::system(fmt::format("ogr2ogr -f {} '{}' '{}' >/dev/null 2>&1", format, to.string(),
                                    from.string())
                            .c_str()),
            0);
  EXPECT_EQ(read_footprints(to).features.size(), 20U) << format;
  return to;
}

TEST(Vector, CutTextFormatsAreRefused) {
  const TemporaryFolder folder;
  for (const auto& [format, extension] :
       {std::pair{"GML", "gml"}, std::pair{"GeoJSONSeq", "geojsonl"}}) {
    const std::string bytes = bytes_of(converted(folder, format, extension));
    const fs::path cut = folder / (std::string("cut.") + extension);
    write_text(cut, bytes.substr(0, bytes.size() * 6 / 10));
    const std::string message = input_error(cut);
    EXPECT_NE(message.find("get it again"), std::string::npos) << message;
  }
}

TEST(Vector, CutFlatGeobufIsNotEmpty) {
  const TemporaryFolder folder;
  const std::string bytes = bytes_of(converted(folder, "FlatGeobuf", "fgb"));
  std::uint32_t header = 0;
  std::memcpy(&header, bytes.data() + 8, 4);
  ASSERT_LT(header + 100, bytes.size());
  for (std::size_t size = header + 12; size < bytes.size(); size += 40) {
    write_text(folder / "cut.fgb", bytes.substr(0, size));
    EXPECT_NE(input_error(folder / "cut.fgb").find("get it again"), std::string::npos) << size;
  }
}

TEST(Vector, PipesAreRefused) {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe.geojson";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(input_error(pipe).find("not an ordinary file"), std::string::npos);
}

/// GDAL would read fewer shapes.
TEST(Vector, MembersOfDifferentExportsAreErrors) {
  const TemporaryFolder folder;
  const std::vector<Polygon> polygons(4, Polygon{{{0, 0}, {9, 0}, {9, 9}}, {}});
  const std::vector<std::string> ids{"w", "x", "y", "z"};
  write_footprints(folder / "a.shp", polygons, ids, {}, {}, "EPSG:28992");
  EXPECT_EQ(read_footprints(folder / "a.shp").features.size(), 4U);
  write_footprints(folder / "b.shp", std::span(polygons).first(3), std::span(ids).first(3), {}, {},
                   "EPSG:28992");
  fs::copy_file(folder / "b.shx", folder / "a.shx", fs::copy_options::overwrite_existing);
  EXPECT_NE(input_error(folder / "a.shp").find("its index has 3 shapes, but a.dbf has 4 records"),
            std::string::npos);
}

TEST(Vector, CutAndBrokenFilesNeverCrash) {
  TETROPOLIS_REQUIRE_DATA(root, ".");
  const TemporaryFolder folder;
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const char* name :
       {"delft_3dfier/footprints.shp", "delft_3dfier/footprints.gpkg",
        "alexandria_dsm_dtm/buildings_wgs84.geojson", "vector_samples/shapefile/polygons.json"}) {
    const std::string good = bytes_of(root / name);
    const fs::path path = folder / ("a" + fs::path(name).extension().string());
    const bool shapefile = path.extension() == ".shp";
    if (shapefile)
      for (const char* member : {".shx", ".dbf"})
        fs::copy_file(fs::path(root / name).replace_extension(member),
                      fs::path(path).replace_extension(member));
    const std::int64_t all = read_footprints(root / name).features_read;
    int failures = 0;
    for (int round = 0; round < 60; ++round) {
      std::string bytes = good;
      if (round < 30)
        bytes.resize(good.size() * static_cast<std::size_t>(round) / 30);
      else
        for (int k = 0; k < 4; ++k)
          bytes[random() % std::min<std::size_t>(bytes.size(), 4000)] = static_cast<char>(random());
      write_text(path, bytes);
      try {
        const FootprintsInput input = read_footprints(path);
        check_account(input);
        // A cut file either fails or tells of every feature.
        if (round < 30 && shapefile) {
          EXPECT_EQ(input.features_read, all);
        }
      } catch (const Error& error) {
        ++failures;
        EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
      }
    }
    EXPECT_GT(failures, 0) << name;
  }
  EXPECT_NE(input_error(folder / "none.shp").find("no such file"), std::string::npos);
  EXPECT_NE(input_error(write_text(folder / "empty.gpkg", "")).find("empty"), std::string::npos);
}

// --- writing ---

struct City {
  std::vector<Polygon> polygons;
  std::vector<std::string> ids;
  std::vector<double> heights;
};

City random_city(std::size_t size) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> unit(0, 1);
  City city;
  for (std::size_t i = 0; i < size; ++i) {
    const double x = 20.0 * static_cast<double>(i);
    Polygon polygon{{{x, 0}, {x, 9 + unit(random)}, {x + 10, 10}, {x + 10 + unit(random), 0}}, {}};
    if (i % 3 == 0) polygon.holes.push_back({{x + 2, 2}, {x + 4, 2}, {x + 3, 4}});
    city.polygons.push_back(polygon);
    city.ids.push_back("house \u00e5 " + std::to_string(i));
    city.heights.push_back(i % 5 == 0 ? std::nan("") : 3 + 50 * unit(random));
  }
  return city;
}

TEST(Vector, WritesWhatItReads) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  const City city = random_city(31);
  const Point2 origin{1024, 2048};  // Small enough for x + origin - origin to be exact below.
  for (const char* name : {"a.shp", "a.gpkg", "a.geojson"}) {
    SCOPED_TRACE(name);
    write_footprints(folder / name, city.polygons, city.ids, city.heights, origin, "EPSG:28992");
    ReadFootprintsOptions options;
    options.id_attribute = "id";
    options.height_attribute = "height";
    const FootprintsInput back = read_footprints(folder / name, options);
    EXPECT_EQ(back.crs, "EPSG:28992");
    EXPECT_TRUE(back.warnings.empty());
    ASSERT_EQ(back.features.size(), city.polygons.size());
    check_account(back);
    for (std::size_t i = 0; i < city.ids.size(); ++i) {
      EXPECT_EQ(back.features[i].source_id, city.ids[i]);
      EXPECT_EQ(std::isnan(back.features[i].height), std::isnan(city.heights[i]));
      if (!std::isnan(city.heights[i])) {
        EXPECT_NEAR(back.features[i].height, city.heights[i], 1e-12);
      }
      EXPECT_NEAR(area(back.features[i].polygon), area(city.polygons[i]), 1e-6);
      EXPECT_EQ(back.features[i].polygon.holes.size(), city.polygons[i].holes.size());
      const Bounds2 box = bounds(city.polygons[i]);
      EXPECT_NEAR(bounds(back.features[i].polygon).xmax, box.xmax + origin.x, 1e-9);
      EXPECT_NEAR(bounds(back.features[i].polygon).ymax, box.ymax + origin.y, 1e-9);
    }
  }
}

TEST(Vector, WritesTheSameBytesAgain) {
  const TemporaryFolder folder;
  const City city = random_city(20);
  for (const char* run : {"first", "second"}) {
    fs::create_directory(folder / run);
    for (const char* name : {"a.shp", "a.gpkg", "a.geojson"})
      write_footprints(folder / run / name, city.polygons, city.ids, city.heights, {84000, 447000},
                       "EPSG:28992");
    EXPECT_EQ(listing(folder / run), (std::set<std::string>{"a.cpg", "a.dbf", "a.geojson", "a.gpkg",
                                                            "a.prj", "a.shp", "a.shx"}));
  }
  for (const std::string& name : listing(folder / "first"))
    EXPECT_TRUE(bytes_of(folder / "first" / name) == bytes_of(folder / "second" / name)) << name;
  // dBASE: bytes 1 to 3 are the date of the last change, years since 1900.
  EXPECT_EQ(bytes_of(folder / "first/a.dbf").substr(1, 3), std::string("\x46\x01\x01"));
}

TEST(Vector, OtherSoftwareSeesTheSame) {
  const auto run = [](const std::string& command) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
        ::popen((command + " 2>/dev/null").c_str(), "r"), ::pclose);
    std::string text;
    std::array<char, 4096> buffer{};
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe.get()))
      text.append(buffer.data(), n);
    return text;
  };
  if (run("ogrinfo --version").empty()) GTEST_SKIP() << "needs ogrinfo";
  const TemporaryFolder folder;
  const std::vector<Polygon> polygons = {
      {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{1, 1}, {1, 2}, {2, 2}}}}};
  const std::vector<std::string> ids = {"x"};
  const std::vector<double> heights = {7.25};
  for (const char* name : {"a.shp", "a.gpkg", "a.geojson"}) {
    write_footprints(folder / name, polygons, ids, heights, {1000, 2000}, "EPSG:3006");
    const std::string text = run("ogrinfo -al '" + (folder / name).string() + "'");
    EXPECT_NE(text.find("SWEREF99 TM"), std::string::npos) << name;
    EXPECT_NE(text.find("Extent: (1000.000000, 2000.000000) - (1004.000000, 2004.000000)"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("id (String"), std::string::npos) << text;
    EXPECT_NE(text.find("7.25"), std::string::npos) << text;
  }
}

TEST(Vector, WritingFailsCleanly) {
  const TemporaryFolder folder;
  const std::vector<Polygon> polygons = {{{{0, 0}, {1, 0}, {1, 1}}, {}}};
  const std::vector<std::string> ids = {"x"};
  const auto kind_of = [&](const fs::path& path, const char* crs) {
    try {
      write_footprints(path, polygons, ids, {}, {}, crs);
    } catch (const Error& error) {
      return static_cast<int>(error.kind());
    }
    return 0;
  };
  EXPECT_EQ(kind_of(folder / "a.kml", ""), 2);
  EXPECT_EQ(kind_of(folder / "a.shp", "nowhere"), 2);
  EXPECT_EQ(kind_of(folder / "none/a.shp", ""), 3);
  EXPECT_TRUE(listing(folder.path()).empty());
  EXPECT_EQ(kind_of(folder / "a.shp", ""), 0);
  EXPECT_EQ(read_footprints(folder / "a.shp").crs, "");
}

}  // namespace
}  // namespace tetropolis
