// Footprint files that are cut, incomplete, ambiguous or say nothing about themselves, through the
// whole pipeline.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>

#include <gdal.h>
#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/vector/vector.h"

#include "defect_city.h"
#include "support/bytes.h"
#include "support/test_data.h"

namespace tetropolis::testing {
namespace {

namespace fs = std::filesystem;

class FileDefects : public ::testing::Test {
 protected:
  FileDefects() {
    write_input(city, sound_features(city), folder.path());
    for (const House& house : city.houses) {
      ids.push_back(house.id);
      polygons.push_back(house.footprint);
      heights.push_back(house.height);
    }
  }

  /// Writes the city's footprints under this name.
  fs::path write(const std::string& name) {
    write_footprints(folder / name, polygons, ids, heights, city.origin, "EPSG:3006");
    return folder / name;
  }

  Outcome run(const fs::path& footprints, const std::vector<std::string>& expected_ids,
              const std::string& id_attribute = "id") {
    Config config = small_config(city, folder.path());
    config.footprints = {footprints.string()};
    config.id_attribute = id_attribute;
    config.layer = layer;
    config.height_attribute = height_attribute;
    fs::remove_all(config.out);
    return build(config, expected_ids);
  }
  Outcome run(const fs::path& footprints) { return run(footprints, ids); }

  void expect_all_buildings(const Outcome& outcome) {
    ASSERT_EQ(outcome.error, "");
    ASSERT_EQ(outcome.city.buildings.size(), city.houses.size());
    for (std::size_t i = 0; i < city.houses.size(); ++i)
      EXPECT_LE(outline_distance(outcome.city.buildings[i].footprint, city.houses[i].footprint),
                2 * kCoordinateStep);
  }

  void expect_input_error(const Outcome& outcome, const fs::path& path, const std::string& text) {
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_NE(outcome.error.find(path.string()), std::string::npos) << outcome.error;
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
  }

  TemporaryFolder folder;
  DefectCity city = defect_city();
  std::vector<std::string> ids;
  std::vector<Polygon> polygons;
  std::vector<double> heights;
  std::string layer, height_attribute;
  const std::vector<std::string> numbers{"0", "1", "2", "3", "4", "5"};  // of a shapefile
};

TEST_F(FileDefects, EveryFormatGivesTheSameCity) {
  for (const char* name : {"a.shp", "a.gpkg", "a.geojson"}) {
    SCOPED_TRACE(name);
    expect_all_buildings(run(write(name)));
  }
}

TEST_F(FileDefects, ShapefileWithoutItsIndexAttributesOrProjection) {
  const fs::path path = write("a.shp");
  fs::remove(folder / "a.shx");
  expect_all_buildings(run(path));
  fs::remove(folder / "a.prj");
  Outcome outcome = run(path);
  expect_all_buildings(outcome);
  EXPECT_TRUE(outcome.has_warning("footprints_crs_unknown"));
  fs::remove(folder / "a.dbf");
  expect_input_error(run(path), path, "has no attribute 'id'");
  expect_all_buildings(run(path, numbers, ""));
}

TEST_F(FileDefects, ShapefileCutOrWithWrongCounts) {
  const fs::path path = write("a.shp");
  std::map<std::string, std::string> sound;
  for (const char* end : {"shp", "shx", "dbf"})
    sound[end] = bytes_of(folder / ("a." + std::string(end)));
  const auto restore = [&] {
    for (const auto& [end, bytes] : sound) write_bytes(folder / ("a." + end), bytes);
  };
  for (const std::size_t size : {3UL, 99UL, 100UL, 150UL, 500UL, sound["shp"].size() - 8}) {
    SCOPED_TRACE(size);
    write_bytes(path, sound["shp"].substr(0, size));
    const Outcome outcome = run(path);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.error;
    EXPECT_NE(outcome.error.find(path.string()), std::string::npos) << outcome.error;
  }
  restore();
  // The index names more records than there are, then less.
  for (const int records : {9, 2}) {
    SCOPED_TRACE(records);
    std::string index = sound["shx"].substr(0, 100);
    for (int i = 0; i < records; ++i)
      index += sound["shx"].substr(100 + 8 * static_cast<std::size_t>(std::min(i, 5)), 8);
    const auto words = static_cast<std::uint32_t>(index.size() / 2);
    for (int k = 0; k < 4; ++k)
      index[24 + static_cast<std::size_t>(k)] = static_cast<char>(words >> (24 - 8 * k));
    write_bytes(folder / "a.shx", index);
    expect_input_error(
        run(path), path,
        "its index has " + std::to_string(records) + " shapes, but a.dbf has 6 records");
  }
  restore();
  // Attributes for three of six: the others have none.
  std::string table = sound["dbf"];
  table[4] = 3;
  write_bytes(folder / "a.dbf", table);
  expect_input_error(run(path), path, "its index has 6 shapes, but a.dbf has 3 records");
  for (const std::size_t size : {20UL, 100UL, sound["dbf"].size() - 20}) {
    write_bytes(folder / "a.dbf", sound["dbf"].substr(0, size));
    expect_input_error(run(path), folder / "a.dbf", "the file is cut");
  }
}

TEST_F(FileDefects, NumbersThatAreNoneInABinaryFile) {
  // Text formats cannot hold them; shapefiles can.
  const double marked = 60 + city.origin.x;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity(), 1e300, -1e18}) {
    SCOPED_TRACE(bad);
    const fs::path path = write("a.shp");
    std::string bytes = bytes_of(path);
    char was[8], is[8];
    std::memcpy(was, &marked, 8);
    std::memcpy(is, &bad, 8);
    // The patient is the last record; its box stays as it was.
    const std::size_t at = bytes.rfind(std::string(was, 8));
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, 8, is, 8);
    write_bytes(path, bytes);
    const Outcome outcome = run(path);
    ASSERT_EQ(outcome.error, "");
    EXPECT_EQ(outcome.city.buildings.size(), 5U);
    EXPECT_NE(outcome.reason_of("patient").find("coordinate"), std::string::npos)
        << outcome.reason_of("patient");
  }
}

TEST_F(FileDefects, LayersOfAFolderCanBeNamed) {
  // A folder of shapefiles is a data source of several layers when one of them is named.
  fs::create_directory(folder / "set");
  write("set/houses.shp");
  write("set/sheds.shp");
  layer = "houses";
  expect_all_buildings(run(folder / "set"));
  layer = "castles";
  expect_input_error(run(folder / "set"), folder / "set", "it has: ");
}

/// Adds the layer of `source` to the GeoPackage `target` under another name.
void copy_layer(const fs::path& source, const fs::path& target, const std::string& name) {
  GDALAllRegister();
  GDALDatasetH in = GDALOpenEx(source.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr);
  GDALDatasetH out =
      GDALOpenEx(target.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE, nullptr, nullptr, nullptr);
  ASSERT_NE(in, nullptr);
  ASSERT_NE(out, nullptr);
  EXPECT_NE(GDALDatasetCopyLayer(out, GDALDatasetGetLayer(in, 0), name.c_str(), nullptr), nullptr);
  GDALClose(out);
  GDALClose(in);
}

TEST_F(FileDefects, GeoPackageWithSeveralLayers) {
  const fs::path path = write("town.gpkg");
  write("old.gpkg");
  write_features(folder / "lamps.csv", {{"l", "POINT(1 2)"}}, city.origin);
  copy_layer(folder / "lamps.csv", path, "lamps");
  expect_all_buildings(run(path));  // one layer of polygons only
  copy_layer(folder / "old.gpkg", path, "town_1990");
  expect_input_error(run(path), path,
                     "has several layers of polygons; set layer to one of: town, town_1990");
  layer = "town_1990";
  expect_all_buildings(run(path));
  layer = "lamps";
  expect_input_error(run(path, {"l"}), path, "a point, not a polygon");
  layer = "Town";
  expect_input_error(run(path), path, "it has: town, lamps, town_1990");
}

TEST_F(FileDefects, GeoJsonInMetresWithoutCrs) {
  std::string text = R"({"type":"FeatureCollection","features":[)";
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    text += i == 0 ? "" : ",";
    text += R"({"type":"Feature","properties":{"id":")" + ids[i] +
            R"("},"geometry":{"type":"Polygon","coordinates":[)";
    for (const Ring* ring :
         {&polygons[i].outer, polygons[i].holes.empty() ? nullptr : polygons[i].holes.data()}) {
      if (ring == nullptr) continue;
      text += ring == &polygons[i].outer ? "[" : ",[";
      for (std::size_t k = 0; k <= ring->size(); ++k) {
        const Point2 p = (*ring)[k % ring->size()];
        text += (k == 0 ? "[" : ",[") + std::to_string(p.x + city.origin.x) + "," +
                std::to_string(p.y + city.origin.y) + "]";
      }
      text += "]";
    }
    text += "]}}";
  }
  write_bytes(folder / "metres.geojson", text + "]}");
  const Outcome outcome = run(folder / "metres.geojson");
  expect_all_buildings(outcome);
  EXPECT_TRUE(outcome.has_warning("footprints_crs_implausible"));
  // Cut in the middle.
  write_bytes(folder / "metres.geojson", text.substr(0, text.size() / 2));
  expect_input_error(run(folder / "metres.geojson"), folder / "metres.geojson", "");
}

TEST_F(FileDefects, NoVectorFileAtAll) {
  write_bytes(folder / "empty.gpkg", "");
  expect_input_error(run(folder / "empty.gpkg"), folder / "empty.gpkg", "empty");
  using std::string_literals::operator""s;  // a literal without it ends at the NUL
  write_bytes(folder / "noise.gpkg", "SQLite format 3\0 but no more"s);
  expect_input_error(run(folder / "noise.gpkg"), folder / "noise.gpkg", "");
  write_bytes(folder / "notes.txt", "a house, a street, a tree\n");
  expect_input_error(run(folder / "notes.txt"), folder / "notes.txt", "not a vector file");
  const Outcome cloud = run(folder / "points.las");
  EXPECT_EQ(cloud.exit_code, 2);
  EXPECT_NE(cloud.error.find("is a point cloud, but given as `footprints`"), std::string::npos)
      << cloud.error;
  expect_input_error(run(folder / "nowhere.shp"), folder / "nowhere.shp", "no such file");
  write_bytes(folder / "none.geojson", R"({"type":"FeatureCollection","features":[]})");
  expect_input_error(run(folder / "none.geojson", {}, ""), folder / "none.geojson",
                     "the file has none");
}

TEST_F(FileDefects, HeightsThatAreNoNumbers) {
  height_attribute = "id";
  const fs::path path = write("a.gpkg");
  expect_input_error(run(path), path, "attribute 'id' has no usable height (feature west: 'west')");
  height_attribute = "hieght";
  expect_input_error(run(path), path, "it has: id, height");
  height_attribute = "height";
  const Outcome outcome = run(path);
  expect_all_buildings(outcome);
  EXPECT_FALSE(outcome.has_warning("height_attribute_empty"));
  // Text with numbers in most places, in a table.
  write_bytes(folder / "b.csv",
              "id,h,WKT\nwest,9.5 m,\"" + moved_wkt(wkt(polygons[0]), city.origin) +
                  "\"\neast,tall,\"" + moved_wkt(wkt(polygons[1]), city.origin) +
                  "\"\nnorth,1e300,\"" + moved_wkt(wkt(polygons[2]), city.origin) + "\"\n");
  height_attribute = "h";
  const Outcome some = run(folder / "b.csv", {"west", "east", "north"});
  ASSERT_EQ(some.error, "");
  EXPECT_TRUE(some.has_warning("height_not_a_number"));
  ReadFootprintsOptions options;
  options.height_attribute = "h";
  const FootprintsInput read = read_footprints(folder / "b.csv", options);
  EXPECT_EQ(read.features[0].height, 9.5);
  EXPECT_TRUE(std::isnan(read.features[1].height));
  EXPECT_TRUE(std::isnan(read.features[2].height));
}

}  // namespace
}  // namespace tetropolis::testing
