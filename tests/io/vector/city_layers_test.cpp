#include "tetropolis/io/vector/city_layers.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "io/crs/gdal_support.h"
#include "support/bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::bytes_of;

constexpr Point2 kOrigin{84000, 447000};

/// A layer as OGR reads it: per feature its attributes as text ("null" without a value), and "wkt".
struct ReadLayer {
  std::vector<std::string> names;
  std::map<std::string, std::string> types;
  std::vector<std::map<std::string, std::string>> features;
};

std::map<std::string, ReadLayer> read_layers(const std::filesystem::path& path) {
  gdal::initialise();
  const gdal::Dataset dataset(GDALOpenEx(path.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
  std::map<std::string, ReadLayer> layers;
  if (dataset == nullptr) return layers;
  for (int l = 0; l < GDALDatasetGetLayerCount(dataset.get()); ++l) {
    OGRLayerH layer = GDALDatasetGetLayer(dataset.get(), l);
    EXPECT_EQ(gdal::canonical_name(OGR_L_GetSpatialRef(layer)), "EPSG:28992");
    ReadLayer& read = layers[OGR_L_GetName(layer)];
    OGRFeatureDefnH columns = OGR_L_GetLayerDefn(layer);
    for (int f = 0; f < OGR_FD_GetFieldCount(columns); ++f) {
      OGRFieldDefnH field = OGR_FD_GetFieldDefn(columns, f);
      read.names.emplace_back(OGR_Fld_GetNameRef(field));
      read.types[read.names.back()] =
          fmt::format("{}{}", OGR_GetFieldTypeName(OGR_Fld_GetType(field)),
                      OGR_Fld_GetSubType(field) == OFSTBoolean ? " boolean" : "");
    }
    while (const gdal::Feature feature{OGR_L_GetNextFeature(layer)}) {
      std::map<std::string, std::string>& values = read.features.emplace_back();
      for (std::size_t f = 0; f < read.names.size(); ++f)
        values[read.names[f]] = OGR_F_IsFieldSetAndNotNull(feature.get(), static_cast<int>(f)) != 0
                                    ? OGR_F_GetFieldAsString(feature.get(), static_cast<int>(f))
                                    : "null";
      OGRGeometryH geometry = OGR_F_GetGeometryRef(feature.get());
      char* wkt = nullptr;
      if (geometry != nullptr) OGR_G_ExportToWkt(geometry, &wkt);
      values["wkt"] = wkt != nullptr ? wkt : "null";
      CPLFree(wkt);
    }
  }
  return layers;
}

Building building(const std::string& id, std::vector<std::string> sources, const Bounds2& box,
                  double h_roof, std::uint32_t flags) {
  return {id, std::move(sources), rectangle(box), 0.125, h_roof, 3, 40, flags, 0};
}

class CityLayers : public ::testing::Test {
 protected:
  /// Six features with names and values of all kinds: two that merge, one alone, one too small, one
  /// outside the domain, one without a geometry.
  CityLayers() {
    const auto feature = [](const char* id, double x, double width, const std::string& more) {
      return fmt::format(
          R"({{"type":"Feature","properties":{{"id":"{0}",{3}}},"geometry":{{"type":"Polygon",)"
          R"("coordinates":[[[{1},447010],[{2},447010],[{2},447020],[{1},447020],[{1},447010]]]}}}})",
          id, 84000 + x, 84000 + x + width, more);
    };
    const std::string all =
        R"("fid":7,"GEOM":"g","H_Roof":1.5,"source_id":"s","source_ID_2":"t","":"e",)"
        R"("big":9007199254740993,"ok":true,"built":"2019-03-05",)"
        R"("seen":"2019-03-05T12:30:15Z","tags":["a","b"],"name":"Café \"'; drop table")";
    const std::string crs =
        R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::28992"}})";
    std::ofstream(scratch / "in.geojson")
        << R"({"type":"FeatureCollection",)" << crs << R"(,"features":[)"
        << feature("a", 10, 10, all) << ',' << feature("b", 20.5, 10, R"("fid":8,"ok":false)")
        << ',' << feature("c", 50, 10, R"("name":"")") << ','
        << feature("d", 70, 1, R"("built":null)") << ',' << feature("e", 900, 10, R"("fid":9)")
        << R"(,{"type":"Feature","properties":{"id":"f","name":"lost"},"geometry":null}]})";
    footprints =
        read_footprints(scratch / "in.geojson", {.id_attribute = "id", .attributes = true});
    for (Footprint& footprint : footprints.features)
      for (Point2& p : footprint.polygon.outer) p = {p.x - kOrigin.x, p.y - kOrigin.y};
    raw.origin = city.origin = kOrigin;
    raw.crs = city.crs = "EPSG:28992";
    raw.buildings = {building("b0", {"a"}, {10, 10, 20, 20}, 9.5, kRoofFromUnclassified),
                     building("b1", {"b"}, {20.5, 10, 30.5, 20}, 7.25, 0),
                     building("b2", {"c"}, {50, 10, 60, 20}, 5.001, kMinimumHeight | kRepaired),
                     building("b3", {"d"}, {70, 10, 71, 20}, 5, 0)};
    city.buildings = {building("b0", {"a", "b"}, {10, 10, 31, 20}, 9, kMerged | kRepaired),
                      building("b1", {"c"}, {50, 10, 60, 20}, 5.001, kMinimumHeight)};
    city.dropped = {{"f", "no geometry"},
                    {"e", "outside the domain", DropCause::kOutside},
                    {"d", "area 10.0 m2 below the minimum of 15 m2", DropCause::kTooSmall}};
  }

  std::map<std::string, ReadLayer> written() const {
    write_city_layers(scratch / "buildings.gpkg", raw, city, footprints);
    return read_layers(scratch / "buildings.gpkg");
  }

  testing::TemporaryFolder scratch;
  FootprintsInput footprints;
  CityModel raw, city;
};

TEST_F(CityLayers, FootprintsKeepTheirAttributesAndTellTheirFate) {
  const ReadLayer layer = written().at("footprints");
  ASSERT_EQ(layer.features.size(), 5U);  // all but the one outside
  const std::map<std::string, std::string> types{{"id", "String"},
                                                 {"fid_2", "Integer64"},
                                                 {"GEOM_2", "String"},
                                                 {"H_Roof_2", "Real"},
                                                 {"source_id_2", "String"},
                                                 {"source_ID_2_2", "String"},
                                                 {"attribute", "String"},
                                                 {"big", "Integer64"},
                                                 {"ok", "Integer boolean"},
                                                 {"built", "Date"},
                                                 {"seen", "DateTime"},
                                                 {"tags", "String"},
                                                 {"name", "String"},
                                                 {"source_id", "String"},
                                                 {"fate", "String"},
                                                 {"tetropolis_id", "String"},
                                                 {"h_ground", "Real"},
                                                 {"h_roof", "Real"},
                                                 {"n_ground_points", "Integer64"},
                                                 {"n_roof_points", "Integer64"},
                                                 {"flags", "String"}};
  EXPECT_EQ(layer.types, types);
  const auto& a = layer.features[0];
  EXPECT_EQ(a.at("fid_2"), "7");
  EXPECT_EQ(a.at("GEOM_2"), "g");
  EXPECT_EQ(a.at("H_Roof_2"), "1.5");
  EXPECT_EQ(a.at("source_id_2"), "s");
  EXPECT_EQ(a.at("source_ID_2_2"), "t");
  EXPECT_EQ(a.at("attribute"), "e");
  EXPECT_EQ(a.at("big"), "9007199254740993");
  EXPECT_EQ(a.at("ok"), "1");
  EXPECT_EQ(a.at("built"), "2019/03/05");
  EXPECT_EQ(a.at("seen"), "2019/03/05 12:30:15+00");
  EXPECT_NE(a.at("tags").find('b'), std::string::npos);
  EXPECT_EQ(a.at("name"), "Café \"'; drop table");
  EXPECT_EQ(a.at("source_id"), "a");
  EXPECT_EQ(a.at("fate"), "merged into b0");
  EXPECT_EQ(a.at("tetropolis_id"), "b0");
  EXPECT_EQ(a.at("h_ground"), "0.125");
  EXPECT_EQ(a.at("h_roof"), "9.5");  // its own, not that of the block
  EXPECT_EQ(a.at("n_roof_points"), "40");
  EXPECT_EQ(a.at("flags"), "roof_from_unclassified");
  EXPECT_EQ(a.at("wkt"),
            "POLYGON ((84010 447010,84020 447010,84020 447020,84010 447020,84010 447010))");
  EXPECT_EQ(layer.features[1].at("ok"), "0");
  EXPECT_EQ(layer.features[1].at("built"), "null");
  const auto& c = layer.features[2];
  EXPECT_EQ(c.at("fate"), "kept");
  EXPECT_EQ(c.at("tetropolis_id"), "b1");
  EXPECT_EQ(c.at("flags"), "minimum_height,repaired");
  EXPECT_EQ(c.at("name"), "");
  const auto& d = layer.features[3];
  EXPECT_EQ(d.at("fate"), "dropped: area 10.0 m2 below the minimum of 15 m2");
  EXPECT_EQ(d.at("tetropolis_id"), "null");
  EXPECT_EQ(d.at("h_roof"), "5");
  const auto& f = layer.features[4];
  EXPECT_EQ(f.at("name"), "lost");
  EXPECT_EQ(f.at("fate"), "dropped: no geometry");
  EXPECT_EQ(f.at("h_roof"), "null");
  EXPECT_EQ(f.at("wkt"), "null");
}

TEST_F(CityLayers, BuildingsAndDroppedAreThoseOfTheCity) {
  const auto layers = written();
  const ReadLayer& buildings = layers.at("buildings");
  ASSERT_EQ(buildings.features.size(), 2U);
  EXPECT_EQ(buildings.features[0].at("tetropolis_id"), "b0");
  EXPECT_EQ(buildings.features[0].at("n_sources"), "2");
  EXPECT_EQ(buildings.features[0].at("source_ids"), R"(["a","b"])");
  EXPECT_EQ(buildings.features[0].at("flags"), "merged,repaired");
  EXPECT_EQ(buildings.features[0].at("wkt"),
            "POLYGON ((84010 447010,84031 447010,84031 447020,84010 447020,84010 447010))");
  EXPECT_EQ(buildings.features[1].at("h_roof"), "5.001");
  const ReadLayer& dropped = layers.at("dropped");
  ASSERT_EQ(dropped.features.size(), 2U);
  EXPECT_EQ(dropped.features[0].at("source_id"), "f");
  EXPECT_EQ(dropped.features[0].at("cause"), "unusable");
  EXPECT_EQ(dropped.features[0].at("wkt"), "null");
  EXPECT_EQ(dropped.features[1].at("cause"), "too_small");
  EXPECT_EQ(dropped.features[1].at("reason"), "area 10.0 m2 below the minimum of 15 m2");
  EXPECT_NE(dropped.features[1].at("wkt").find("84070"), std::string::npos);
}

TEST_F(CityLayers, PartsHaveALayerIfThereAreAny) {
  EXPECT_EQ(written().count("parts"), 0U);
  RoofPart& shed = city.buildings[0].parts.emplace_back();
  shed.outline.outer = {{10, 10}, {20, 10}, {20, 20}, {10, 20}};
  shed.roof = {{10, 10}, 6, 0.5, 0};
  shed.source_id = "a";
  shed.lod = Lod::k2_2;
  shed.n_points = 12;
  shed.rmse = 0.25;
  RoofPart& flat = city.buildings[0].parts.emplace_back();
  flat.outline.outer = {{20, 10}, {31, 10}, {31, 20}, {20, 20}};
  flat.roof.elevation = 7.5;
  flat.source_id = "b";
  flat.lod = Lod::kBlock;
  flat.rmse = std::nan("");
  const ReadLayer layer = written().at("parts");
  EXPECT_EQ(layer.names,
            (std::vector<std::string>{"tetropolis_id", "part", "source_id", "lod", "slope",
                                      "azimuth", "area", "rmse", "n_points", "h_min", "h_max"}));
  ASSERT_EQ(layer.features.size(), 2U);
  std::map<std::string, std::string> expected{
      {"tetropolis_id", "b0"},
      {"part", "0"},
      {"source_id", "a"},
      {"lod", "2.2"},
      {"slope", "26.57"},
      {"azimuth", "270"},
      {"area", "100"},
      {"rmse", "0.25"},
      {"n_points", "12"},
      {"h_min", "6"},
      {"h_max", "11"},
      {"wkt", "POLYGON ((84010 447010,84020 447010,84020 447020,84010 447020,84010 447010))"}};
  EXPECT_EQ(layer.features[0], expected);
  expected = {
      {"tetropolis_id", "b0"},
      {"part", "1"},
      {"source_id", "b"},
      {"lod", "block"},
      {"slope", "0"},
      {"azimuth", "null"},
      {"area", "110"},
      {"rmse", "null"},
      {"n_points", "0"},
      {"h_min", "7.5"},
      {"h_max", "7.5"},
      {"wkt", "POLYGON ((84020 447010,84031 447010,84031 447020,84020 447020,84020 447010))"}};
  EXPECT_EQ(layer.features[1], expected);
}

TEST_F(CityLayers, AreTheSameBytesEachTime) {
  written();
  const std::string first = bytes_of(scratch / "buildings.gpkg");
  written();
  EXPECT_TRUE(first == bytes_of(scratch / "buildings.gpkg"));
  EXPECT_GT(first.size(), 1000U);
}

TEST_F(CityLayers, AsManyAttributesAsSqliteHasRoomFor) {
  for (int c = 0; c < 2500; ++c)
    footprints.attributes.push_back({fmt::format("c{}", c), AttributeType::kInteger,
                                     std::vector<std::int64_t>(6, c), std::vector<bool>(6, true)});
  const ReadLayer layer = written().at("footprints");
  EXPECT_EQ(layer.names.size(), 1900U + 8);
  EXPECT_EQ(layer.features.at(3).at("c1000"), "1000");
}

TEST_F(CityLayers, NeedNeitherFootprintsNorCrs) {
  city = raw = {};
  footprints = {};
  write_city_layers(scratch / "empty.gpkg", raw, city, footprints);
  const std::vector<VectorLayer> layers = list_layers(scratch / "empty.gpkg");
  ASSERT_EQ(layers.size(), 3U);
  for (const VectorLayer& layer : layers) EXPECT_EQ(layer.features, 0) << layer.name;
}

}  // namespace
}  // namespace tetropolis
