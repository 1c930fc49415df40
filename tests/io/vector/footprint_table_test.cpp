#include "tetropolis/io/vector/footprint_table.h"

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <cpl_conv.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <ogr_api.h>

#include "tetropolis/core/error.h"

#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

OGRGeometryH geometry_of(std::string wkt) {
  char* text = wkt.data();
  OGRGeometryH geometry = nullptr;
  OGR_G_CreateFromWkt(&text, nullptr, &geometry);
  return geometry;
}

std::string wkb_of(const std::string& wkt) {
  OGRGeometryH geometry = geometry_of(wkt);
  std::vector<unsigned char> bytes(static_cast<std::size_t>(OGR_G_WkbSize(geometry)));
  OGR_G_ExportToIsoWkb(geometry, wkbNDR, bytes.data());
  OGR_G_DestroyGeometry(geometry);
  return {bytes.begin(), bytes.end()};
}

std::string json_of(const std::string& wkt) {
  OGRGeometryH geometry = geometry_of(wkt);
  char* text = OGR_G_ExportToJson(geometry);
  std::string json = text;
  CPLFree(text);
  OGR_G_DestroyGeometry(geometry);
  return json;
}

std::string text_or_null(const std::string& text) {
  return text.empty() ? "null" : '"' + text + '"';
}

const std::vector<std::string> kShapes = {
    "POLYGON ((0 0,10 0,10 10,0 10,0 0),(2 2,2 4,4 4,4 2,2 2))",
    "MULTIPOLYGON (((20 0,30 0,30 10,20 0)),((40 0,50 0,50 10,40 0)))",
    "POLYGON Z ((60 0 5,70 0 5,70 10 5,60 0 5))",
    "LINESTRING (0 0,1 1)",
};

FootprintTable table_of(const std::vector<std::string>& shapes) {
  FootprintTable table;
  for (const std::string& shape : shapes) table.wkb.push_back(wkb_of(shape));
  return table;
}

TEST(FootprintTable, IsWhatAFileWithItsFeaturesIs) {
  const testing::TemporaryFolder folder;
  FootprintTable table = table_of(kShapes);
  table.ids = {"a", "b", "", "a"};
  table.columns = {{"tall", AttributeType::kText, {"12.5 m", "7", "", ""}}};
  table.crs = "EPSG:28992";
  std::string features;
  for (std::size_t i = 0; i < kShapes.size(); ++i)
    features += fmt::format(
        R"({}{{"type":"Feature","id":{},"properties":{{"name":{},"tall":{}}},"geometry":{}}})",
        i == 0 ? "" : ",", i, text_or_null(table.ids[i]), text_or_null(table.columns[0].values[i]),
        json_of(kShapes[i]));
  std::ofstream(folder / "a.geojson")
      << R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:28992"}},)"
      << R"("features":[)" << features << "]}";
  for (const char* target : {"", "EPSG:7415", "EPSG:32631"}) {
    ReadFootprintsOptions options;
    options.id_attribute = "name";
    options.height_attribute = "tall";
    options.target_crs = target;
    const FootprintsInput file = read_footprints(folder / "a.geojson", options);
    const FootprintsInput taken = take_footprints(table, options);
    EXPECT_EQ(taken.crs, file.crs);
    EXPECT_EQ(taken.features_read, file.features_read);
    ASSERT_EQ(file.features.size(), 4U);
    ASSERT_EQ(taken.features.size(), file.features.size());
    for (std::size_t i = 0; i < file.features.size(); ++i) {
      EXPECT_EQ(taken.features[i].source_id, file.features[i].source_id);
      EXPECT_EQ(taken.features[i].polygon, file.features[i].polygon);
      EXPECT_TRUE(taken.features[i].height == file.features[i].height ||
                  (std::isnan(taken.features[i].height) && std::isnan(file.features[i].height)));
    }
    EXPECT_EQ(taken.features[0].height, 12.5);
    ASSERT_EQ(taken.dropped.size(), file.dropped.size());
    for (std::size_t i = 0; i < file.dropped.size(); ++i) {
      EXPECT_EQ(taken.dropped[i].source_id, file.dropped[i].source_id);
      EXPECT_EQ(taken.dropped[i].reason, file.dropped[i].reason);
    }
    EXPECT_EQ(taken.bounds, file.bounds);
  }
}

/// Floors, what is below ground, and conditions on numbers.
TEST(FootprintTable, AttributesMeanWhatTheyMeanInFiles) {
  FootprintTable table = table_of({kShapes[0], kShapes[2], kShapes[0], kShapes[2]});
  table.columns = {{"building:levels", AttributeType::kInteger, {"4", "10", "", "2"}},
                   {"location", AttributeType::kText, {"", "", "underground", ""}},
                   {"listed", AttributeType::kBoolean, {"1", "0", "", "1"}}};
  ReadFootprintsOptions options;
  options.attributes = true;
  const FootprintsInput taken = take_footprints(table, options);
  ASSERT_EQ(taken.features.size(), 3U);
  EXPECT_EQ(taken.features[0].height, 12);
  EXPECT_TRUE(taken.features[1].from_floors);
  ASSERT_EQ(taken.dropped.size(), 1U);
  EXPECT_EQ(taken.dropped[0].cause, DropCause::kNotABuilding);
  ASSERT_EQ(taken.attributes.size(), 3U);
  EXPECT_EQ(taken.attributes[0].type, AttributeType::kInteger);
  EXPECT_EQ(taken.attributes[2].type, AttributeType::kBoolean);
  EXPECT_EQ(std::get<std::vector<std::int64_t>>(taken.attributes[0].values)[1], 10);
  options.where = "\"building:levels\" > 3";  // as text, 10 would come before 3
  EXPECT_EQ(take_footprints(table, options).features.size(), 2U);
}

TEST(FootprintTable, BuildingsThatBeginAboveTheGroundAreTold) {
  const std::string aside = "POLYGON ((80 0,90 0,90 10,80 0))";
  FootprintTable table = table_of({kShapes[0], kShapes[2], kShapes[0], kShapes[2], aside});
  // A canopy, a bridge in metres and one in floors, a house, and what stands on a part.
  table.columns = {{"building", AttributeType::kText, {"roof", "yes", "yes", "yes", ""}},
                   {"building:part", AttributeType::kText, {"", "", "", "", "yes"}},
                   {"min_height", AttributeType::kText, {"", "4 m", "", "0", "12"}},
                   {"building:min_level", AttributeType::kText, {"", "", "1", "0", "4"}}};
  const auto open_below = [&] {
    std::string ids;
    for (const Footprint& feature : take_footprints(table, {}).features)
      if (feature.is_open_below) ids += feature.source_id;
    return ids;
  };
  EXPECT_EQ(open_below(), "012");
  // Where nothing says that they are OpenStreetMap's, such numbers are of roofs.
  table.columns = {{"min_height", AttributeType::kText, {"4", "4", "4", "4", "4"}}};
  EXPECT_EQ(open_below(), "");
}

TEST(FootprintTable, FeaturesWithoutNamesAreNumbered) {
  FootprintTable table = table_of({kShapes[0], kShapes[2]});
  table.wkb.insert(table.wkb.begin() + 1, "");  // no geometry
  const FootprintsInput plain = take_footprints(table);
  ASSERT_EQ(plain.features.size(), 2U);
  EXPECT_EQ(plain.features[0].source_id, "0");
  EXPECT_EQ(plain.features[1].source_id, "2");
  ASSERT_EQ(plain.dropped.size(), 1U);
  EXPECT_EQ(plain.dropped[0].source_id, "1");
  ASSERT_EQ(plain.warnings.size(), 1U);
  EXPECT_EQ(plain.warnings[0].code, "footprints_crs_unknown");
  table.ids = {"x", "y", "z"};  // an index: no attribute is asked for
  EXPECT_EQ(take_footprints(table).features[1].source_id, "z");
}

TEST(FootprintTable, MistakesAreTold) {
  const auto message_of = [](const FootprintTable& table, ErrorKind kind,
                             const ReadFootprintsOptions& options = {}) -> std::string {
    return testing::error_of([&] { take_footprints(table, options); }, kind);
  };
  FootprintTable table = table_of(kShapes);
  table.wkb[1].resize(20);
  EXPECT_EQ(message_of(table, ErrorKind::kInput),
            "footprints: feature 1: its geometry is no well-known binary");
  table = table_of(kShapes);
  table.ids = {"a"};
  EXPECT_EQ(message_of(table, ErrorKind::kUsage),
            "footprints: 1 ids for 4 features; give one per feature");
  table.ids = {};
  table.columns = {{"tall", AttributeType::kText, {"tall", "", "", ""}}};
  ReadFootprintsOptions heights;
  heights.height_attribute = "tall";
  EXPECT_NE(message_of(table, ErrorKind::kInput, heights).find("has no usable height"),
            std::string::npos);
  table.crs = "EPSG:1";
  EXPECT_NE(message_of(table, ErrorKind::kUsage), "");
}

}  // namespace
}  // namespace tetropolis
