#include "tetropolis/io/cityjson/cityjson.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/vector/vector.h"

#include "support/bytes.h"
#include "support/errors.h"
#include "support/roofs.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::bytes_of;
using testing::TemporaryFolder;

fs::path write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  return path;
}

std::string input_error(const fs::path& path) {
  return testing::input_error(path, [&] { read_city(path); });
}

/// A model with every feature: holes, odd names, negative and long numbers.
CityModel random_city(std::size_t size) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> unit(0, 1);
  CityModel model;
  model.origin = {84800, 447400};
  model.crs = "EPSG:28992";
  model.domain = {snap_coordinate(-10.1234), snap_coordinate(-20), snap_coordinate(2000.5),
                  snap_coordinate(1000.0001)};
  for (std::size_t i = 0; i < size; ++i) {
    Building b;
    b.id = "b" + std::to_string(7 * i + 3);
    b.source_ids = {"G0503.\u00e9\"\\\n" + std::to_string(i)};
    if (i % 4 == 0) b.source_ids.push_back("x#" + std::to_string(i));
    const double x = 20.0 * static_cast<double>(i % 50) - 30;
    const double y = 20.0 * static_cast<double>(i / 50) - 30;
    const auto at = [&](double u, double v) {
      return snap_coordinate(Point2{x + u + unit(random), y + v + unit(random)});
    };
    b.footprint.outer = {at(0, 0), at(12, 0), at(13, 7), at(6, 9), at(0, 8)};
    if (i % 3 == 0) b.footprint.holes.push_back({at(2, 2), at(3, 4), at(5, 3)});
    if (i % 6 == 0) b.footprint.holes.push_back({at(7, 2), at(7, 5), at(9, 4)});
    b.h_ground = -5 + 10 * unit(random);
    b.h_roof = b.h_ground + 2.5 + 100 * unit(random);
    b.n_ground_points = static_cast<std::int64_t>(random() % 100000);
    b.n_roof_points = static_cast<std::int64_t>(random() % 100000);
    b.flags = random() % 512;
    if (i % 2 == 0) b.attribute_height = 30 * unit(random);
    model.buildings.push_back(std::move(b));
  }
  model.dropped = {{"17#2", "smaller than 15 m\u00b2"}, {"", "crosses the domain boundary"}};
  return model;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

bool same_bits(const Ring& a, const Ring& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same_bits(a[i].x, b[i].x) || !same_bits(a[i].y, b[i].y)) return false;
  return true;
}

void expect_same(const CityModel& a, const CityModel& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.domain, b.domain);
  EXPECT_EQ(a.crs, b.crs);
  ASSERT_EQ(a.buildings.size(), b.buildings.size());
  for (std::size_t i = 0; i < a.buildings.size(); ++i) {
    const Building& p = a.buildings[i];
    const Building& q = b.buildings[i];
    SCOPED_TRACE(p.id);
    EXPECT_EQ(p.id, q.id);
    EXPECT_EQ(p.source_ids, q.source_ids);
    EXPECT_TRUE(same_bits(p.footprint.outer, q.footprint.outer));
    ASSERT_EQ(p.footprint.holes.size(), q.footprint.holes.size());
    for (std::size_t h = 0; h < p.footprint.holes.size(); ++h)
      EXPECT_TRUE(same_bits(p.footprint.holes[h], q.footprint.holes[h]));
    EXPECT_TRUE(same_bits(p.h_ground, q.h_ground));
    EXPECT_TRUE(same_bits(p.h_roof, q.h_roof));
    EXPECT_TRUE(same_bits(p.attribute_height, q.attribute_height));
    EXPECT_EQ(p.n_ground_points, q.n_ground_points);
    EXPECT_EQ(p.n_roof_points, q.n_roof_points);
    EXPECT_EQ(p.flags, q.flags);
    ASSERT_EQ(p.parts.size(), q.parts.size());
    for (std::size_t k = 0; k < p.parts.size(); ++k) {
      const RoofPart &s = p.parts[k], &t = q.parts[k];
      EXPECT_TRUE(same_bits(s.outline.outer, t.outline.outer));
      ASSERT_EQ(s.outline.holes.size(), t.outline.holes.size());
      for (std::size_t h = 0; h < s.outline.holes.size(); ++h)
        EXPECT_TRUE(same_bits(s.outline.holes[h], t.outline.holes[h]));
      EXPECT_EQ(s.roof, t.roof);
      EXPECT_EQ(s.source_id, t.source_id);
      EXPECT_EQ(s.lod, t.lod);
      EXPECT_EQ(s.n_points, t.n_points);
      EXPECT_TRUE(s.rmse == t.rmse || (std::isnan(s.rmse) && std::isnan(t.rmse)));
    }
  }
  ASSERT_EQ(a.dropped.size(), b.dropped.size());
  for (std::size_t i = 0; i < a.dropped.size(); ++i) {
    EXPECT_EQ(a.dropped[i].source_id, b.dropped[i].source_id);
    EXPECT_EQ(a.dropped[i].reason, b.dropped[i].reason);
  }
}

TEST(CityJson, RoundTripKeepsEveryBit) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  CityModel model = random_city(300);
  write_city(folder / "a.city.json", model, "Delft");
  const CityModel back = read_city(folder / "a.city.json");
  expect_same(model, back);
  write_city(folder / "b.city.json", back, "Delft");
  EXPECT_TRUE(bytes_of(folder / "a.city.json") == bytes_of(folder / "b.city.json"));
  // Far from the origin, and without a known system.
  model.origin = {-6'400'000, 9'000'001};
  model.crs = "";
  write_city(folder / "a.city.json", model);
  expect_same(model, read_city(folder / "a.city.json"));
  // A system without a code.
  model.crs = normalise_crs("+proj=tmerc +lat_0=52 +lon_0=5.1 +ellps=GRS80 +units=m");
  write_city(folder / "a.city.json", model);
  expect_same(model, read_city(folder / "a.city.json"));
  CityModel empty;
  empty.domain = {0, 0, 100, 100};
  write_city(folder / "c.city.json", empty);
  expect_same(empty, read_city(folder / "c.city.json"));
}

TEST(CityJson, ClockwiseInputIsTurned) {
  const TemporaryFolder folder;
  CityModel model = random_city(1);
  const Ring outer = model.buildings[0].footprint.outer;
  Ring& turned = model.buildings[0].footprint.outer;
  std::reverse(turned.begin() + 1, turned.end());
  write_city(folder / "a.json", model);
  EXPECT_TRUE(same_bits(read_city(folder / "a.json").buildings[0].footprint.outer, outer));
}

using Vertex = std::array<double, 3>;

/// Six times the volume under an oriented polygon fan; the sum over a closed surface that looks
/// outwards is six times its volume.
double volume_term(const std::vector<Vertex>& ring) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const Vertex& a = ring[0];
    const Vertex& b = ring[i];
    const Vertex& c = ring[i + 1];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum;
}

TEST(CityJson, SolidsAreClosedAndLookOutwards) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  CityModel model = random_city(60);
  for (std::size_t i = 0; i < model.buildings.size(); i += 5) {
    // Rings the wrong way round must not turn the solid inside out.
    Polygon& footprint = model.buildings[i].footprint;
    std::reverse(footprint.outer.begin(), footprint.outer.end());
    for (Ring& hole : footprint.holes) std::reverse(hole.begin(), hole.end());
  }
  write_city(folder / "a.json", model);
  const Json file = Json::parse(bytes_of(folder / "a.json"));
  std::vector<Vertex> vertices;
  std::set<std::vector<std::int64_t>> unique;
  for (const Json& v : file["vertices"]) {
    ASSERT_TRUE(v[0].is_number_integer() && v[1].is_number_integer() && v[2].is_number_integer());
    vertices.push_back(
        {v[0].get<double>() / 1e4, v[1].get<double>() / 1e4, v[2].get<double>() / 1e4});
    EXPECT_TRUE(unique.insert(v.get<std::vector<std::int64_t>>()).second) << "repeated vertex";
  }
  std::set<std::size_t> used;
  for (const Building& building : model.buildings) {
    SCOPED_TRACE(building.id);
    const Json& geometry = file["CityObjects"][building.id]["geometry"][0];
    EXPECT_EQ(geometry["type"], "Solid");
    EXPECT_EQ(geometry["lod"], "1.2");
    const Json& shell = geometry["boundaries"][0];
    const Json& values = geometry["semantics"]["values"][0];
    ASSERT_EQ(shell.size(), values.size());
    std::map<std::pair<std::size_t, std::size_t>, int> edges;
    double volume = 0;
    for (std::size_t f = 0; f < shell.size(); ++f) {
      const std::string type =
          geometry["semantics"]["surfaces"][values[f].get<std::size_t>()]["type"];
      for (const Json& ring : shell[f]) {
        std::vector<Vertex> points;
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const auto a = ring[i].get<std::size_t>();
          const auto b = ring[(i + 1) % ring.size()].get<std::size_t>();
          ++edges[{a, b}];
          used.insert(a);
          points.push_back(vertices.at(a));
          if (type == "GroundSurface") {
            EXPECT_NEAR(vertices[a][2], building.h_ground, 5.1e-5);
          }
          if (type == "RoofSurface") {
            EXPECT_NEAR(vertices[a][2], building.h_roof, 5.1e-5);
          }
        }
        volume += volume_term(points) / 6;
        if (type == "WallSurface") {
          EXPECT_EQ(ring.size(), 4U);
        }
      }
      EXPECT_EQ(shell[f].size(), type == "WallSurface" ? 1 : 1 + building.footprint.holes.size());
    }
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << "open edge";
    }
    const double height = building.h_roof - building.h_ground;
    EXPECT_NEAR(volume, area(building.footprint) * height, 2e-4 * area(building.footprint));
  }
  EXPECT_EQ(used.size(), vertices.size());
}

/// Buildings of several roofs, far enough from each other.
CityModel roofed_city(std::size_t size) {
  std::mt19937 random(testing::test_seed());
  CityModel model;
  model.origin = {84800, 447400};
  model.crs = "EPSG:28992";
  for (std::size_t i = 0; i < size; ++i) {
    Building building = testing::brick_building(
        random, 3 + i % 3, 3 + i % 2,
        {60.0 * static_cast<double>(i % 10), 60.0 * static_cast<double>(i / 10)},
        0.3 * static_cast<double>(i));
    building.id = "b" + std::to_string(i + 1);
    if (i % 4 == 1)
      for (RoofPart& part : building.parts) part.lod = i % 8 == 1 ? Lod::k1_2 : Lod::kBlock;
    if (i % 4 == 2)
      for (RoofPart& part : building.parts) part.lod = std::min(part.lod, Lod::k1_3);
    model.buildings.push_back(std::move(building));
  }
  return model;
}

TEST(CityJson, RoundTripKeepsEveryBitOfParts) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  CityModel model = roofed_city(40);
  RoofPlane& low = model.buildings[0].parts[0].roof;
  low = snap_plane({low.at, low.elevation, -1e-9, 1e-9});  // -0
  for (const Point2 origin : {Point2{84800, 447400}, Point2{-6'400'000, 9'000'001}}) {
    model.origin = origin;
    write_city(folder / "a.city.json", model, "Delft");
    std::vector<Warning> warnings;
    const CityModel back = read_city(folder / "a.city.json", &warnings);
    EXPECT_TRUE(warnings.empty()) << warnings.front().message;
    expect_same(model, back);
    write_city(folder / "b.city.json", back, "Delft");
    EXPECT_TRUE(bytes_of(folder / "a.city.json") == bytes_of(folder / "b.city.json"));
  }
}

TEST(CityJson, SolidsOfPartsAreClosedManifoldAndOnTheirPlanes) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  const CityModel model = roofed_city(60);
  write_city(folder / "a.json", model);
  const Json file = Json::parse(bytes_of(folder / "a.json"));
  std::vector<Vertex> vertices;
  for (const Json& v : file["vertices"])
    vertices.push_back(
        {v[0].get<double>() / 1e4, v[1].get<double>() / 1e4, v[2].get<double>() / 1e4});
  std::size_t crossings = 0, steps = 0;
  for (const Building& building : model.buildings) {
    SCOPED_TRACE(building.id);
    const Json& geometries = file["CityObjects"][building.id]["geometry"];
    Lod highest = Lod::k1_2;
    for (const RoofPart& part : building.parts) highest = std::max(highest, part.lod);
    ASSERT_EQ(geometries.size(), highest == Lod::k1_2 ? 1U : 2U);
    EXPECT_EQ(geometries.front()["lod"], "1.2");
    const Json& geometry = geometries.back();
    EXPECT_EQ(geometry["lod"], name_of(highest));
    ASSERT_EQ(geometry["boundaries"].size(), 1U);
    const Json& shell = geometry["boundaries"][0];
    const Json& values = geometry["semantics"]["values"][0];
    ASSERT_EQ(shell.size(), values.size());
    std::map<std::pair<std::size_t, std::size_t>, int> edges;
    double volume = 0, roofs = 0;
    for (std::size_t f = 0; f < shell.size(); ++f) {
      const auto value = values[f].get<std::size_t>();
      const Json& surface = geometry["semantics"]["surfaces"][value];
      for (const Json& ring : shell[f]) {
        std::vector<Vertex> points;
        std::set<std::size_t> own;
        Ring plan;
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const auto a = ring[i].get<std::size_t>();
          EXPECT_TRUE(own.insert(a).second) << "a ring passes a vertex twice";
          ++edges[{a, ring[(i + 1) % ring.size()].get<std::size_t>()}];
          points.push_back(vertices.at(a));
          plan.push_back({points.back()[0], points.back()[1]});
        }
        volume += volume_term(points) / 6;
        if (surface["type"] == "GroundSurface") {
          for (const Vertex& p : points) {
            EXPECT_NEAR(p[2], building.h_ground, 5.1e-5);
          }
        } else if (surface["type"] == "RoofSurface") {
          const RoofPart& part = building.parts[value - 1];
          roofs += signed_area(plan);
          EXPECT_EQ(surface["source_id"], part.source_id);
          // Corners on the plane; crossings within what a millimetre or two make.
          const double climb = std::hypot(part.roof.slope_x, part.roof.slope_y);
          for (const Vertex& p : points)
            EXPECT_NEAR(p[2], part.roof({p[0], p[1]}), 1.1e-3 + 2.1e-3 * climb);
          const double slope = surface["slope"];
          EXPECT_NEAR(std::tan(slope * std::acos(-1.0) / 180), climb, 1e-3);
          EXPECT_EQ(surface.contains("azimuth"), climb > 0);
          if (climb > 0) {
            const double azimuth = surface["azimuth"].get<double>() * std::acos(-1.0) / 180;
            const Point2 at = part.roof.at;
            const Point2 downhill{at.x + std::sin(azimuth), at.y + std::cos(azimuth)};
            EXPECT_NEAR(part.roof(downhill), part.roof(at) - climb, 1e-3);
          }
          if (surface.contains("crossings")) crossings += surface["crossings"].size();
        } else {
          // In one vertical plane.
          double farthest = 0;
          for (const Point2& p : plan)
            farthest = std::max(farthest, distance_to_segment(p, plan[0], plan[1]));
          EXPECT_LT(farthest, 1e-9);
          if (surface["wall"] == "step") ++steps;
        }
      }
    }
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << "open edge";
    }
    const double plan = area(building.footprint);
    EXPECT_NEAR(roofs, plan, 1e-3 * plan);
    // The parts' volumes by their triangles from a corner, whatever side of it they are on.
    double expected = 0;
    for (const RoofPart& part : building.parts) {
      for_each_ring(part.outline, [&](const Ring& ring) {
        for (std::size_t i = 1; i + 1 < ring.size(); ++i)
          expected += signed_area({ring[0], ring[i], ring[i + 1]}) *
                      ((part.roof(ring[0]) + part.roof(ring[i]) + part.roof(ring[i + 1])) / 3 -
                       building.h_ground);
      });
    }
    EXPECT_NEAR(volume, expected, 3e-3 * plan);
    EXPECT_NEAR(file["CityObjects"][building.id]["attributes"]["volume"].get<double>(), expected,
                1e-3);
  }
  EXPECT_GT(crossings, 100U);
  EXPECT_GT(steps, 100U);
}

TEST(CityJson, FilesOfOursWhosePartsDoNotFitAreRefused) {
  const TemporaryFolder folder;
  const CityModel model = roofed_city(1);
  write_city(folder / "a.json", model);
  const Json file = Json::parse(bytes_of(folder / "a.json"));
  const auto message = [&](const auto& edit) {
    Json edited = file;
    edit(edited, edited["CityObjects"]["b1"]["geometry"].back());
    return input_error(write_text(folder / "b.json", edited.dump()));
  };
  EXPECT_NE(message([](Json&, Json& solid) {
              solid["semantics"]["surfaces"][1]["roof_plane"][2] = 99;
            }).find("above a corner of the roof"),
            std::string::npos);
  EXPECT_NE(message([](Json&, Json& solid) {
              solid["semantics"]["surfaces"][1]["roof_plane"].erase(0);
            }).find("is not x, y, z, slope_x, slope_y"),
            std::string::npos);
  EXPECT_NE(message([](Json&, Json& solid) {
              solid["boundaries"][0].erase(1);
              solid["semantics"]["values"][0].erase(1);
            }).find("has roofs that"),
            std::string::npos);
  EXPECT_NE(message([](Json&, Json& solid) {
              solid["semantics"]["surfaces"][1]["lod"] = "3";
            }).find("is not block, 1.2, 1.3 or 2.2"),
            std::string::npos);
  // A solid that is open is no reason not to go on.
  Json edited = file;
  Json& solid = edited["CityObjects"]["b1"]["geometry"].back();
  solid["boundaries"][0].erase(solid["boundaries"][0].size() - 1);
  solid["semantics"]["values"][0].erase(solid["semantics"]["values"][0].size() - 1);
  std::vector<Warning> warnings;
  expect_same(read_city(write_text(folder / "b.json", edited.dump()), &warnings), model);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].code, "city_solids_differ");
}

TEST(CityJson, DocumentFollowsTheSpecification) {
  const TemporaryFolder folder;
  const CityModel model = random_city(5);
  write_city(folder / "a.json", model, "A \"title\"");
  const Json file = Json::parse(bytes_of(folder / "a.json"));
  EXPECT_EQ(file["type"], "CityJSON");
  EXPECT_EQ(file["version"], "2.0");
  EXPECT_EQ(file["transform"]["scale"], (std::vector<double>{1e-4, 1e-4, 1e-4}));
  EXPECT_EQ(file["transform"]["translate"], (std::vector<double>{84800, 447400, 0}));
  EXPECT_EQ(file["metadata"]["title"], "A \"title\"");
  EXPECT_EQ(file["metadata"]["referenceSystem"], "https://www.opengis.net/def/crs/EPSG/0/28992");
  const auto extent = file["metadata"]["geographicalExtent"].get<std::vector<double>>();
  ASSERT_EQ(extent.size(), 6U);
  Bounds2 box{1e9, 1e9, -1e9, -1e9};
  double top = -1e9;
  for (const Building& building : model.buildings) {
    const Bounds2 own = bounds(building.footprint);
    box = {std::min(box.xmin, own.xmin), std::min(box.ymin, own.ymin), std::max(box.xmax, own.xmax),
           std::max(box.ymax, own.ymax)};
    top = std::max(top, building.h_roof);
    const Json& object = file["CityObjects"][building.id];
    EXPECT_EQ(object["type"], "Building");
    const Json& attributes = object["attributes"];
    EXPECT_EQ(attributes["tetropolis_id"], building.id);
    EXPECT_EQ(attributes["source_ids"], building.source_ids);
    EXPECT_EQ(attributes["h_ground"].get<double>(), building.h_ground);
    EXPECT_EQ(attributes["flags"], flag_names(building.flags));
  }
  EXPECT_NEAR(extent[0], box.xmin + 84800, 1e-9);
  EXPECT_NEAR(extent[4], box.ymax + 447400, 1e-9);
  EXPECT_NEAR(extent[5], top, 5.1e-5);
  // What it adds to the format is the extension that it declares.
  const Json extension =
      Json::parse(bytes_of(std::filesystem::path(TETROPOLIS_SOURCE) / "docs/tetropolis.ext.json"));
  EXPECT_EQ(file["extensions"]["Tetropolis"],
            Json({{"url", extension["url"]}, {"version", extension["version"]}}));
  for (const auto& [key, value] : file.items())
    EXPECT_TRUE(key.front() != '+' || extension["extraRootProperties"].contains(key)) << key;
  EXPECT_EQ(file["+tetropolis"]["domain"][0].get<double>(), 84800 - 10.1234);
  EXPECT_EQ(file["+tetropolis"]["dropped"][0]["source_id"], "17#2");
}

TEST(CityJson, TextThatIsNoUtf8StaysReadable) {
  const TemporaryFolder folder;
  CityModel model = random_city(1);
  model.buildings[0].source_ids = {"caf\xE9", "\xF0\x9F\x8F\xA0", "\xED\xA0\x80", "a\x01z"};
  write_city(folder / "a.json", model);
  EXPECT_EQ(read_city(folder / "a.json").buildings[0].source_ids,
            (std::vector<std::string>{"caf\xEF\xBF\xBD", "\xF0\x9F\x8F\xA0",
                                      "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD", "a\x01z"}));
}

// --- files of others ---

TEST(CityJson, ReadsTheHague) {
  TETROPOLIS_REQUIRE_DATA(path, "cityjson/DenHaag_01.city.json");
  std::vector<Warning> warnings;
  const CityModel model = read_city(path, &warnings);
  EXPECT_EQ(model.crs, "EPSG:28992");
  EXPECT_TRUE(model.domain.empty());
  const Json file = Json::parse(bytes_of(path));
  // Every part and every building with geometry of its own.
  std::set<std::string> expected;
  for (const auto& [key, object] : file["CityObjects"].items())
    if (object["type"] != "TINRelief" && object.contains("geometry") && !object["geometry"].empty())
      expected.insert(key);
  EXPECT_EQ(expected.size(), 1653U + 337U);
  std::set<std::string> seen;
  for (const Building& building : model.buildings) {
    const std::string key = building.source_ids.at(0).substr(0, building.source_ids[0].find('#'));
    seen.insert(key);
    ASSERT_EQ(expected.count(key), 1U) << key;
    const Json& object = file["CityObjects"][key];
    EXPECT_GT(signed_area(building.footprint.outer), 0);
    EXPECT_LT(building.h_ground, building.h_roof);
    EXPECT_GE(building.h_ground, 2.4);
    EXPECT_LE(building.h_roof, 37.5);
    // The ridge and the eaves are attributes that were measured apart from the geometry.
    if (object.contains("attributes") && object["attributes"].contains("AbsoluteRidgeHeight")) {
      const double ridge = object["attributes"]["AbsoluteRidgeHeight"];
      const double eaves = object["attributes"]["AbsoluteEavesHeight"];
      EXPECT_LE(building.h_roof, ridge + 0.01) << key;
      EXPECT_GE(building.h_roof, eaves - 0.01) << key;
    }
  }
  for (const Dropped& dropped : model.dropped) seen.insert(dropped.source_id);
  EXPECT_EQ(seen, expected);
  EXPECT_LT(model.dropped.size(), 20U);
  std::set<std::string> told;
  for (const Warning& warning : warnings) told.insert(warning.code);
  std::set<std::string> due{"city_roofs_flattened", "city_terrain_unread"};
  if (!model.dropped.empty()) due.insert("city_objects_dropped");
  EXPECT_EQ(told, due);
}

/// Of 1,990 real buildings: what faces look like tells as much as their semantics.
TEST(CityJson, RealBuildingsWithoutSemanticsHaveTheSameFootprintsAndHeights) {
  TETROPOLIS_REQUIRE_DATA(path, "cityjson/DenHaag_01.city.json");
  const TemporaryFolder folder;
  Json file = Json::parse(bytes_of(path));
  for (Json& object : file["CityObjects"])
    if (object.contains("geometry"))
      for (Json& geometry : object["geometry"]) geometry.erase("semantics");
  const CityModel named = read_city(path);
  // Keys of a dump are in another order.
  const CityModel unnamed = read_city(write_text(folder / "a.json", file.dump()));
  std::map<std::string, const Building*> by_source;
  for (const Building& building : unnamed.buildings) by_source[building.source_ids[0]] = &building;
  ASSERT_EQ(by_source.size(), named.buildings.size());
  std::size_t same = 0;
  for (const Building& building : named.buildings) {
    const Building& other = *by_source.at(building.source_ids[0]);
    // Roofs that become parts make the footprint.
    EXPECT_NEAR(area(other.footprint), area(building.footprint),
                building.parts.empty() ? 1e-6 : 0.1);
    EXPECT_EQ(other.h_ground, building.h_ground);
    EXPECT_NEAR(other.h_roof, building.h_roof, 0.5);
    if (std::abs(other.h_roof - building.h_roof) < 0.01) ++same;
  }
  EXPECT_GT(static_cast<double>(same), 0.98 * static_cast<double>(named.buildings.size()));
}

/// A building of faces, each of rings. `values`: 0 for ground, 1 for roofs; null: no semantics.
std::string building_of(const std::vector<std::vector<std::vector<Point3>>>& faces,
                        const Json& values) {
  Json vertices = Json::array(), boundaries = Json::array();
  for (const auto& face : faces) {
    Json rings = Json::array();
    for (const std::vector<Point3>& ring : face) {
      Json indices = Json::array();
      for (const Point3& p : ring) {
        indices.push_back(vertices.size());
        vertices.push_back(
            {std::lround(1000 * p[0]), std::lround(1000 * p[1]), std::lround(1000 * p[2])});
      }
      rings.push_back(indices);
    }
    boundaries.push_back(rings);
  }
  Json geometry{{"type", "MultiSurface"}, {"lod", "2.2"}, {"boundaries", boundaries}};
  if (!values.is_null())
    geometry["semantics"] = {{"surfaces", {{{"type", "GroundSurface"}}, {{"type", "RoofSurface"}}}},
                             {"values", values}};
  return Json{
      {"type", "CityJSON"},
      {"version", "2.0"},
      {"transform", {{"scale", {0.001, 0.001, 0.001}}, {"translate", {0, 0, 0}}}},
      {"CityObjects", {{"a", {{"type", "Building"}, {"geometry", Json::array({geometry})}}}}},
      {"vertices", vertices}}
      .dump();
}

/// A building of roof faces over the ground face of 10 m x 10 m at height 1.
std::string building_with_roof(const std::vector<std::vector<Point3>>& roofs, bool semantics) {
  std::vector<std::vector<std::vector<Point3>>> faces{
      {{{0, 0, 1}, {0, 10, 1}, {10, 10, 1}, {10, 0, 1}}}};
  Json values = Json::array({0});
  for (const auto& roof : roofs) {
    faces.push_back({roof});
    values.push_back(1);
  }
  return building_of(faces, semantics ? values : Json());
}

TEST(CityJson, RoofsOfOthersBecomeFlatAtTheirNinetiethPercentile) {
  const TemporaryFolder folder;
  const double side = std::sqrt(0.1);
  const std::vector<Point3> hall{{0, 0, 7}, {10, 0, 7}, {10, 10, 7}, {0, 10, 7}};
  const std::vector<Point3> chimney{{4, 4, 45}, {5, 4, 45}, {5, 5, 45}, {4, 5, 45}};
  const std::vector<Point3> tower{{0, 0, 30}, {4, 0, 30}, {4, 4, 30}, {0, 4, 30}};
  const std::vector<Point3> south{{0, 0, 5}, {10, 0, 5}, {10, 5, 9}, {0, 5, 9}};
  const std::vector<Point3> north{{0, 5, 9}, {10, 5, 9}, {10, 10, 5}, {0, 10, 5}};
  struct Case {
    std::vector<std::vector<Point3>> faces;
    double height;
    bool flattened;
    bool parts;  // if semantics say that these are roofs
  };
  for (const Case& c : std::initializer_list<Case>{
           {{hall}, 7, false, false},
           {{hall, chimney}, 7, true, false},
           {{hall, tower}, 30, false, false},
           {{south, north}, 5 + 0.9 * 4, false, true},
           // A pyramid: of the area, (1 - t)^2 is above the share t of its height.
           {{{{0, 0, 2}, {10, 0, 2}, {5, 5, 12}},
             {{10, 0, 2}, {10, 10, 2}, {5, 5, 12}},
             {{10, 10, 2}, {0, 10, 2}, {5, 5, 12}},
             {{0, 10, 2}, {0, 0, 2}, {5, 5, 12}}},
            2 + (1 - side) * 10,
            true,
            true}})
    for (const bool semantics : {true, false}) {
      std::vector<Warning> warnings;
      const CityModel model = read_city(
          write_text(folder / "a.json", building_with_roof(c.faces, semantics)), &warnings);
      ASSERT_EQ(model.buildings.size(), 1U);
      EXPECT_NEAR(model.buildings[0].h_roof, c.height, 2e-6);
      EXPECT_EQ(model.buildings[0].h_ground, 1);
      const bool is_roofed = !model.buildings[0].parts.empty();
      // The hall beside the tower loses its height where semantics say that it is a roof.
      const bool is_hall_raised = semantics && c.height == 30;
      EXPECT_EQ(warnings.size(), (c.flattened || is_hall_raised) && !is_roofed ? 1U : 0U);
      EXPECT_EQ(is_roofed, semantics && c.parts);
    }
}

/// A block around a yard, in which a tower stands.
/// Corners of roofs that lie on a longer edge of a neighbour become corners of both.
TEST(CityJson, RoofsOfOthersBecomePartsThatShareTheirCorners) {
  const TemporaryFolder folder;
  // A hall along the whole north side; a shed and a tower on the south side, met in the middle.
  const std::vector<std::vector<Point3>> roofs{
      {{0, 5, 6}, {10, 5, 6}, {10, 10, 8}, {0, 10, 8}},
      {{0, 0, 4}, {5.004, 0, 4}, {5.004, 5.003, 4}, {0, 5, 4}},
      {{5.004, 0, 9}, {10, 0, 9}, {10, 5, 9}, {5.004, 5.003, 9}}};
  const CityModel model = read_city(write_text(folder / "a.json", building_with_roof(roofs, true)));
  ASSERT_EQ(model.buildings.size(), 1U);
  const Building& building = model.buildings[0];
  ASSERT_EQ(building.parts.size(), 3U);
  EXPECT_EQ(building.parts[0].outline.outer,
            (Ring{{0, 5}, {5.004, 5.003}, {10, 5}, {10, 10}, {0, 10}}));
  EXPECT_NEAR(building.parts[0].roof({3, 10}), 8, 1e-3);
  EXPECT_NEAR(building.parts[0].roof({3, 5}), 6, 1e-3);
  EXPECT_EQ(building.parts[1].roof, snap_plane({{0, 0}, 4, 0, 0}));
  EXPECT_EQ(building.parts[2].lod, Lod::k2_2);
  EXPECT_EQ(building.parts[2].source_id, "a");
  EXPECT_TRUE(std::isnan(building.parts[2].rmse));
  EXPECT_EQ(building.footprint.outer,
            (Ring{{0, 0}, {5.004, 0}, {10, 0}, {10, 5}, {10, 10}, {0, 10}, {0, 5}}));
  // A gap, an overlap, eaves, a roof below the ground: blocks, with the footprint of the ground.
  const std::vector<Point3> eaves{{-0.3, 5, 6}, {10, 5, 6}, {10, 10, 8}, {-0.3, 10, 8}};
  const std::vector<Point3> sunk{{0, 5, 6}, {10, 5, 6}, {10, 10, 0.9}, {0, 10, 0.9}};
  for (const auto& faces : std::initializer_list<std::vector<std::vector<Point3>>>{
           {roofs[0], roofs[1]},
           {roofs[0], roofs[1], roofs[2], roofs[2]},
           {eaves, roofs[1], roofs[2]},
           {sunk, roofs[1], roofs[2]}}) {
    std::vector<Warning> warnings;
    const CityModel block =
        read_city(write_text(folder / "a.json", building_with_roof(faces, true)), &warnings);
    ASSERT_EQ(block.buildings.size(), 1U);
    EXPECT_TRUE(block.buildings[0].parts.empty());
    EXPECT_EQ(block.buildings[0].footprint.outer.size(), 4U);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings[0].code, "city_roofs_flattened");
  }
}

/// Of 430 buildings of 3DBAG: what the file says of its roofs is what the parts say.
TEST(CityJson, ReadsTheRoofsOf3dbag) {
  TETROPOLIS_REQUIRE_DATA(path, "roofs/3dbag_models/3dbag_v210908_5910.json");
  const TemporaryFolder folder;
  const CityModel model = read_city(path);
  const Json file = Json::parse(bytes_of(path));
  const std::vector<double> scale = file["transform"]["scale"];
  const std::vector<double> translate = file["transform"]["translate"];
  std::size_t with_parts = 0, corners = 0;
  for (const Building& building : model.buildings) {
    if (building.parts.empty()) continue;
    ++with_parts;
    const std::string& key = building.source_ids[0];
    SCOPED_TRACE(key);
    double plan = 0;
    for (const RoofPart& part : building.parts) plan += area(part.outline);
    EXPECT_NEAR(plan, area(building.footprint), 1e-6 * plan);
    const Json* solid = nullptr;
    for (const Json& geometry : file["CityObjects"][key.substr(0, key.find('#'))]["geometry"])
      if (geometry["lod"] == "2.2" || geometry["lod"] == 2.2) solid = &geometry;
    ASSERT_NE(solid, nullptr);
    if (key.find('#') != std::string::npos) continue;
    const Json& shell = (*solid)["boundaries"][0];
    std::size_t roofs = 0;
    for (std::size_t f = 0; f < shell.size(); ++f) {
      const std::size_t value = (*solid)["semantics"]["values"][0][f];
      if ((*solid)["semantics"]["surfaces"][value]["type"] != "RoofSurface") continue;
      if (roofs == building.parts.size()) break;  // of another piece
      const RoofPlane& roof = building.parts[roofs++].roof;
      for (const Json& v : shell[f][0]) {
        const Json& p = file["vertices"][v.get<std::size_t>()];
        const auto at = [&](std::size_t axis) {
          return p[axis].get<double>() * scale[axis] + translate[axis];
        };
        EXPECT_NEAR(roof({at(0) - model.origin.x, at(1) - model.origin.y}), at(2), 0.051);
        ++corners;
      }
    }
  }
  EXPECT_GT(with_parts, 420U);
  EXPECT_GT(corners, 5000U);
  write_city(folder / "a.json", model);
  std::vector<Warning> warnings;
  expect_same(read_city(folder / "a.json", &warnings), model);
  EXPECT_TRUE(warnings.empty());
}

TEST(CityJson, PiecesWithinEachOtherHaveHeightsOfTheirOwn) {
  const TemporaryFolder folder;
  const auto square = [](double low, double high, double z, bool up) {
    std::vector<Point3> ring{{low, low, z}, {high, low, z}, {high, high, z}, {low, high, z}};
    if (!up) std::reverse(ring.begin(), ring.end());
    return ring;
  };
  const CityModel model = read_city(
      write_text(folder / "a.json", building_of({{square(0, 40, 0, false), square(10, 30, 0, true)},
                                                 {square(0, 40, 8, true), square(10, 30, 8, false)},
                                                 {square(17, 23, 1, false)},
                                                 {square(17, 23, 30, true)}},
                                                {0, 1, 0, 1})));
  ASSERT_EQ(model.buildings.size(), 2U);
  for (const Building& building : model.buildings) {
    const bool is_block = !building.footprint.holes.empty();
    EXPECT_EQ(building.h_ground, is_block ? 0 : 1);
    EXPECT_EQ(building.h_roof, is_block ? 8 : 30);
  }
}

TEST(CityJson, TheGroundOfABodyTurnedInsideOutIsNoRoof) {
  const TemporaryFolder folder;
  const std::vector<Point3> slope{{0, 0, 1}, {10, 0, 1}, {10, 10, 6}, {0, 10, 6}};
  const std::vector<Point3> roof{{0, 0, 12}, {0, 10, 12}, {10, 10, 12}, {10, 0, 12}};
  const CityModel model =
      read_city(write_text(folder / "a.json", building_of({{slope}, {roof}}, Json())));
  ASSERT_EQ(model.buildings.size(), 1U);
  EXPECT_EQ(model.buildings[0].h_roof, 12);
}

TEST(CityJson, FloorsWithoutSemanticsAreNoRoofs) {
  const TemporaryFolder folder;
  std::vector<std::vector<Point3>> floors;
  for (int storey = 1; storey <= 30; ++storey) {
    const double z = 1 + 3.0 * storey;
    floors.push_back({{0, 0, z}, {10, 0, z}, {10, 10, z}, {0, 10, z}});
  }
  const CityModel model =
      read_city(write_text(folder / "a.json", building_with_roof(floors, false)));
  ASSERT_EQ(model.buildings.size(), 1U);
  EXPECT_EQ(model.buildings[0].h_roof, 91);
}

/// Where semantics do not tell of a roof: a dormer, floors, or what is too low; and vertices too
/// far out for a height to the micrometre.
TEST(CityJson, RoofsThatSemanticsDoNotTellAreAsHighAsTheHighestVertex) {
  const TemporaryFolder folder;
  const std::vector<Point3> dormer{{4, 4, 5}, {5, 4, 5}, {5, 5, 5}, {4, 5, 5}};
  const std::vector<Point3> yard{{0, 0, 2.2}, {10, 0, 2.2}, {10, 10, 2.2}, {0, 10, 2.2}};
  const std::vector<Point3> mast{{4, 4, 12}, {5, 4, 12}, {5, 5, 12}, {4, 5, 12}};
  const std::vector<Point3> down{{0, 0, 8}, {0, 10, 8}, {10, 10, 8}, {10, 0, 8}};
  const std::vector<Point3> far{
      {0, 0, 1.5e10}, {10, 0, 1.5e10}, {10, 10, 1.5e10 + 8}, {0, 10, 1.5e10 + 8}};
  using Faces = std::vector<std::vector<Point3>>;
  for (const auto& [faces, height] :
       {std::pair{Faces{dormer}, 5.0}, std::pair{Faces{yard, mast}, 12.0},
        std::pair{Faces{down}, 8.0}, std::pair{Faces{far}, 1.5e10 + 8}}) {
    const CityModel model =
        read_city(write_text(folder / "a.json", building_with_roof(faces, true)));
    ASSERT_EQ(model.buildings.size(), 1U);
    EXPECT_NEAR(model.buildings[0].h_roof / height, 1, 1e-9);
  }
}

TEST(CityJson, SolidsOtherThanTheirGroundAndHeightsAreNamed) {
  const TemporaryFolder folder;
  const CityModel model = random_city(3);
  ASSERT_GT(model.buildings.size(), 1U);
  write_city(folder / "a.json", model);
  std::vector<Warning> warnings;
  read_city(folder / "a.json", &warnings);
  EXPECT_TRUE(warnings.empty());
  const Json file = Json::parse(bytes_of(folder / "a.json"));
  const std::string& id = model.buildings[1].id;
  const auto expect_named = [&](const char* what, const auto& edit) {
    SCOPED_TRACE(what);
    Json edited = file;
    Json& object = edited["CityObjects"][id];
    edit(object["attributes"], object["geometry"][0]["boundaries"][0], edited["vertices"]);
    warnings.clear();
    read_city(write_text(folder / "b.json", edited.dump()), &warnings);
    // The corner may be one that bounds the whole model.
    std::erase_if(warnings, [](const Warning& w) { return w.code == "city_extent_differs"; });
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings[0].code, "city_solids_differ");
    EXPECT_EQ(warnings[0].count, 1);
    EXPECT_NE(warnings[0].message.find("(first: " + id + ")"), std::string::npos);
  };
  // Faces: the ground, the roof, walls. 200 steps are 2 cm.
  expect_named("attribute", [](Json& attributes, Json&, Json&) {
    attributes["h_roof"] = attributes["h_roof"].get<double>() + 0.02;
  });
  for (std::size_t axis = 0; axis < 3; ++axis)
    expect_named("corner of the roof", [&](Json&, Json& faces, Json& vertices) {
      Json& coordinate = vertices[faces[1][0][2].get<std::size_t>()][axis];
      coordinate = coordinate.get<std::int64_t>() + 200;
    });
  expect_named("corner of the ground", [](Json&, Json& faces, Json& vertices) {
    Json& x = vertices[faces[0][0][0].get<std::size_t>()][0];
    x = x.get<std::int64_t>() + 200;
  });
  expect_named("face of the roof",
               [](Json&, Json& faces, Json&) { std::swap(faces[1][0][0], faces[1][0][1]); });
  expect_named("wall", [](Json&, Json& faces, Json&) { faces[2][0][0] = faces[3][0][1]; });
  expect_named("wall turned", [](Json&, Json& faces, Json&) {
    std::reverse(faces[3][0].begin(), faces[3][0].end());
  });
  expect_named("wall missing", [](Json&, Json& faces, Json&) { faces.erase(4); });
  expect_named("inside out", [](Json&, Json& faces, Json&) {
    for (Json& face : faces)
      for (Json& ring : face) std::reverse(ring.begin(), ring.end());
  });
  expect_named("roof on the ground", [](Json&, Json& faces, Json&) {
    faces[1][0] = faces[0][0];
    std::reverse(faces[1][0].begin(), faces[1][0].end());
    for (std::size_t k = faces.size() - 1; k > 1; --k) faces.erase(k);
  });
  // Ground and roof trade places: what the ground face is at is not h_ground.
  Json turned = file;
  turned["CityObjects"][id]["geometry"][0]["semantics"]["values"][0][0] = 1;
  turned["CityObjects"][id]["geometry"][0]["semantics"]["values"][0][1] = 0;
  warnings.clear();
  read_city(write_text(folder / "b.json", turned.dump()), &warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].code, "city_solids_differ");
}

TEST(CityJson, WhatOurFilesSayTwiceHasToAgree) {
  const TemporaryFolder folder;
  CityModel model = random_city(3);
  model.crs = "EPSG:3006";
  write_city(folder / "a.json", model);
  const Json file = Json::parse(bytes_of(folder / "a.json"));
  const auto error_of = [&](const Json& edited) -> std::string {
    return testing::error_of([&] { read_city(write_text(folder / "b.json", edited.dump())); });
  };
  EXPECT_EQ(error_of(file), "");
  Json crs = file;
  crs["+tetropolis"]["crs"] = "EPSG:28992";
  EXPECT_NE(error_of(crs).find("/+tetropolis/crs is EPSG:28992, but /metadata/referenceSystem "
                               "EPSG:3006"),
            std::string::npos)
      << error_of(crs);
  Json box = file;
  std::swap(box["+tetropolis"]["domain"][0], box["+tetropolis"]["domain"][2]);
  EXPECT_NE(error_of(box).find("/+tetropolis/domain is not XMIN, YMIN, XMAX, YMAX"),
            std::string::npos)
      << error_of(box);
  for (std::size_t side = 0; side < 6; ++side) {
    Json extent = file;
    Json& value = extent["metadata"]["geographicalExtent"][side];
    value = value.get<double>() + 0.02;
    std::vector<Warning> warnings;
    read_city(write_text(folder / "b.json", extent.dump()), &warnings);
    ASSERT_EQ(warnings.size(), 1U) << side;
    EXPECT_EQ(warnings[0].code, "city_extent_differs");
  }
}

TEST(CityJson, ReadsThe3dfierReference) {
  TETROPOLIS_REQUIRE_DATA(folder, "delft_3dfier");
  const fs::path path = folder / "reference/3dfier_output_cityjson.json";
  const CityModel model = read_city(path);
  EXPECT_EQ(model.crs, "EPSG:28992");
  const Json file = Json::parse(bytes_of(path));
  ReadFootprintsOptions options;
  const FootprintsInput footprints = read_footprints(folder / "footprints.shp", options);
  double expected_area = 0;
  for (const Footprint& footprint : footprints.features) expected_area += area(footprint.polygon);
  double total = 0;
  std::set<std::string> keys;
  for (const Building& building : model.buildings) {
    total += area(building.footprint);
    const std::string key = building.source_ids.at(0).substr(0, building.source_ids[0].find('#'));
    keys.insert(key);
    const Json& attributes = file["CityObjects"][key]["attributes"];
    // Another percentile than that of the geometry's roof.
    EXPECT_NEAR(building.h_roof, attributes["measuredHeight"].get<double>(), 1.0) << key;
  }
  EXPECT_EQ(keys.size(), 160U);
  EXPECT_TRUE(model.dropped.empty());
  EXPECT_NEAR(total, expected_area, 0.01 * expected_area);
}

const char* const kTwoParts = R"({"type":"CityJSON","version":"1.1",
"metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/7415"},
"transform":{"scale":[0.001,0.001,0.001],"translate":[100.5,200.25,0]},
"CityObjects":{
"z":{"type":"Building","children":["y"]},
"y":{"type":"BuildingPart","parents":["z"],"geometry":[
 {"type":"MultiSurface","lod":"0","boundaries":[[[0,1,2,3]]]},
 {"type":"Solid","lod":"2.2","boundaries":[[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]]}]},
"road":{"type":"Road","geometry":[]},
"flat":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"0","boundaries":[[[0,1,2,3]]]}]},
"none":{"type":"Building"},
"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":1,"boundaries":[[[4,5,6,7]],[[0,1,5,4]]],
 "semantics":{"surfaces":[{"type":"RoofSurface"}],"values":[0,null]}}]}},
"vertices":[[0,0,1000],[10000,0,1000],[10000,5000,1000],[0,5000,1000],
            [0,0,9000],[10000,0,9000],[10000,5000,9000],[0,5000,9000]]})";

TEST(CityJson, TerrainOfOthersIsNamed) {
  const TemporaryFolder folder;
  Json file = Json::parse(kTwoParts);
  for (const std::int64_t reliefs : {0, 1}) {
    std::vector<Warning> warnings;
    read_city(write_text(folder / "a.json", file.dump()), &warnings);
    std::int64_t told = 0;
    for (const Warning& warning : warnings)
      if (warning.code == "city_terrain_unread") told += warning.count;
    EXPECT_EQ(told, reliefs);
    file["CityObjects"]["road"]["type"] = "TINRelief";
  }
}

TEST(CityJson, TypesOfExtensionsAreNamed) {
  const TemporaryFolder folder;
  Json file = Json::parse(kTwoParts);
  std::vector<Warning> warnings;
  EXPECT_EQ(read_city(write_text(folder / "a.json", file.dump()), &warnings).buildings.size(), 2U);
  const auto unknown = [&] {
    return std::find_if(warnings.begin(), warnings.end(),
                        [](const Warning& w) { return w.code == "city_types_unknown"; });
  };
  EXPECT_EQ(unknown(), warnings.end());
  file["CityObjects"]["y"]["type"] = "+SpecialBuilding";
  warnings.clear();
  EXPECT_EQ(read_city(write_text(folder / "a.json", file.dump()), &warnings).buildings.size(), 1U);
  ASSERT_NE(unknown(), warnings.end());
  EXPECT_EQ(unknown()->count, 1);
  EXPECT_NE(unknown()->message.find("first: +SpecialBuilding"), std::string::npos)
      << unknown()->message;
}

/// kTwoParts holds boxes of 10 m x 5 m on ground at 1 m, 8 m high.
TEST(CityJson, FeetAndDegreesBecomeMetres) {
  const TemporaryFolder folder;
  constexpr double kFoot = 1200.0 / 3937;  // the US survey foot
  const double north = 1e-3 / 111'000;     // degrees of latitude in a millimetre
  const double east = north / std::cos(35.6 * 3.14159265358979 / 180);
  struct Case {
    const char* code;
    std::array<double, 3> scale, translate;
    bool is_north_first;
    const char* crs;
    bool warns;
  };
  const double mm = 1e-3 / kFoot;
  for (const Case& c :
       {Case{"2263", {mm, mm, mm}, {983'000, 199'000, 0}, false, "EPSG:32118", true},
        Case{"4326", {east, north, 0.001}, {139.7, 35.6, 0}, false, "EPSG:32654", false},
        Case{"6697", {north, east, 0.001}, {35.6, 139.7, 0}, true, "EPSG:32654", false}}) {
    SCOPED_TRACE(c.code);
    Json file = Json::parse(kTwoParts);
    file["metadata"]["referenceSystem"] =
        std::string("https://www.opengis.net/def/crs/EPSG/0/") + c.code;
    file["transform"] = {{"scale", c.scale}, {"translate", c.translate}};
    if (c.is_north_first)
      for (Json& v : file["vertices"]) std::swap(v[0], v[1]);
    std::vector<Warning> warnings;
    const CityModel model = read_city(write_text(folder / "a.json", file.dump()), &warnings);
    EXPECT_EQ(model.crs, c.crs);
    ASSERT_EQ(model.buildings.size(), 2U);
    EXPECT_NEAR(area(model.buildings[0].footprint), 50, 0.5);
    EXPECT_NEAR(model.buildings[0].h_ground, 1, 0.002);
    EXPECT_NEAR(model.buildings[0].h_roof, 9, 0.002);
    EXPECT_EQ(std::any_of(warnings.begin(), warnings.end(),
                          [](const Warning& w) { return w.code == "model_units"; }),
              c.warns);
  }
}

/// A height of an outline in CityGML 2.0 and in 3.0.
TEST(CityJson, HeightsOfCityGmlAreReadInBothVersions) {
  const TemporaryFolder folder;
  for (const char* height : {"<bldg:measuredHeight uom=\"m\">18.5</bldg:measuredHeight>",
                             "<con:height><con:Height><con:value "
                             "uom=\"m\">18.5</con:value></con:Height></con:height>"}) {
    const std::string text =
        std::string(
            "<?xml version=\"1.0\"?><CityModel xmlns:gml=\"http://www.opengis.net/gml\" "
            "xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\" "
            "xmlns:con=\"http://www.opengis.net/citygml/construction/3.0\">"
            "<gml:boundedBy><gml:Envelope srsName=\"EPSG:25832\"/></gml:boundedBy>"
            "<bldg:Building gml:id=\"b\">") +
        height +
        "<bldg:lod0FootPrint><gml:MultiSurface><gml:surfaceMember><gml:Polygon><gml:exterior>"
        "<gml:LinearRing><gml:posList>0 0 5 20 0 5 20 10 5 0 10 5 0 0 5</gml:posList>"
        "</gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember></gml:MultiSurface>"
        "</bldg:lod0FootPrint></bldg:Building></CityModel>";
    const CityModel model = read_city(write_text(folder / "a.gml", text));
    ASSERT_EQ(model.buildings.size(), 1U);
    EXPECT_EQ(model.buildings[0].h_roof - model.buildings[0].h_ground, 18.5) << height;
  }
}

/// Of Stuttgart, where the northing is no easting.
TEST(CityJson, EastingsFirstAreToldByWhereTheSystemIsUsed) {
  const TemporaryFolder folder;
  for (const bool is_east_first : {false, true}) {
    std::string places;
    for (const auto& [x, y] : {std::pair{0, 0}, {20, 0}, {20, 10}, {0, 10}, {0, 0}}) {
      const int east = 3'512'345 + x, north = 5'403'210 + y;
      places += fmt::format("{} {} 5 ", is_east_first ? east : north, is_east_first ? north : east);
    }
    const std::string text =
        "<?xml version=\"1.0\"?><CityModel xmlns:gml=\"http://www.opengis.net/gml\" "
        "xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\"><gml:boundedBy><gml:Envelope "
        "srsName=\"urn:ogc:def:crs,crs:EPSG::31467,crs:EPSG::5783\"/></gml:boundedBy>"
        "<bldg:Building gml:id=\"b\"><bldg:measuredHeight>9</bldg:measuredHeight>"
        "<bldg:lod0FootPrint><gml:MultiSurface><gml:surfaceMember><gml:Polygon><gml:exterior>"
        "<gml:LinearRing><gml:posList>" +
        places +
        "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
        "</gml:MultiSurface></bldg:lod0FootPrint></bldg:Building></CityModel>";
    std::vector<Warning> warnings;
    const CityModel model = read_city(write_text(folder / "a.gml", text), &warnings);
    ASSERT_EQ(model.buildings.size(), 1U);
    EXPECT_EQ(model.crs, "EPSG:31467");
    EXPECT_EQ(bounds(model.buildings[0].footprint).moved(model.origin),
              (Bounds2{3'512'345, 5'403'210, 3'512'365, 5'403'220}));
    EXPECT_EQ(std::any_of(warnings.begin(), warnings.end(),
                          [](const Warning& w) { return w.code == "model_axes"; }),
              is_east_first);
  }
}

TEST(CityJson, FilesInNumbersOfTheirReferenceSystemHaveAnOriginNearby) {
  const TemporaryFolder folder;
  Json file = Json::parse(kTwoParts);
  for (Json& v : file["vertices"]) {
    v[0] = v[0].get<std::int64_t>() + 319'030'500;
    v[1] = v[1].get<std::int64_t>() + 6'396'030'250;
  }
  file["transform"]["translate"] = {0, 0, 0};
  const CityModel model = read_city(write_text(folder / "a.json", file.dump()));
  EXPECT_EQ(model.origin, (Point2{319030, 6396030}));
  const Ring expected = {{0.5, 0.25}, {10.5, 0.25}, {10.5, 5.25}, {0.5, 5.25}};
  EXPECT_EQ(model.buildings[0].footprint.outer, expected);
  // A vertex that no object has, at zero of the system, moves nothing.
  file = Json::parse(kTwoParts);
  file["transform"]["translate"] = {319030, 6396030, 0};
  file["vertices"].push_back({-319'030'000, -6'396'030'000, 0});
  EXPECT_EQ(read_city(write_text(folder / "a.json", file.dump())).origin,
            (Point2{319030, 6396030}));
}

TEST(CityJson, PiecesOfOneObjectHaveHeightsOfTheirOwn) {
  const TemporaryFolder folder;
  Json file = Json::parse(kTwoParts);
  Json& solid = file["CityObjects"]["y"]["geometry"][1];
  Json& vertices = file["vertices"];
  // A second one 40 m to the east, 3 m higher.
  Json other = solid["boundaries"];
  for (Json& shell : other)
    for (Json& surface : shell)
      for (Json& ring : surface)
        for (Json& index : ring) {
          Json vertex = vertices[index.get<std::size_t>()];
          vertex[0] = vertex[0].get<std::int64_t>() + 40'000;
          vertex[2] = vertex[2].get<std::int64_t>() + 3'000;
          index = vertices.size();
          vertices.push_back(vertex);
        }
  solid["type"] = "MultiSolid";
  solid["boundaries"] = {solid["boundaries"], other};
  const CityModel model = read_city(write_text(folder / "a.json", file.dump()));
  ASSERT_EQ(model.buildings.size(), 3U);
  const Building &first = model.buildings[1], &second = model.buildings[2];
  EXPECT_EQ(second.source_ids, (std::vector<std::string>{"y#2"}));
  // Not the key of another object.
  file["CityObjects"]["y#2"] = file["CityObjects"]["a"];
  std::set<std::string> ids;
  for (const Building& building : read_city(write_text(folder / "b.json", file.dump())).buildings)
    EXPECT_TRUE(ids.insert(building.source_ids.front()).second) << building.source_ids.front();
  EXPECT_EQ(ids, (std::set<std::string>{"a", "y", "y#2", "y#3"}));
  EXPECT_EQ(second.footprint.outer[0].x, first.footprint.outer[0].x + 40);
  EXPECT_EQ(second.h_ground, first.h_ground + 3);
  EXPECT_EQ(second.h_roof, first.h_roof + 3);
}

TEST(CityJson, ASequenceIsReadAsTheFileThatHasAllItsObjects) {
  const TemporaryFolder folder;
  const Json file = Json::parse(kTwoParts);
  Json head = file;
  head["CityObjects"] = Json::object();
  head["vertices"] = Json::array();
  // A feature per object, with a vertex before those of the file.
  Json vertices = file["vertices"];
  vertices.insert(vertices.begin(), Json{77, 77, 77});
  const auto shift = [](const auto& self, Json& item) -> void {
    if (item.is_array())
      for (Json& inner : item) self(self, inner);
    else
      item = item.get<std::size_t>() + 1;
  };
  std::string lines = head.dump() + "\n";
  for (const auto& [key, object] : file["CityObjects"].items()) {
    Json shifted = object;
    for (Json& geometry : shifted.contains("geometry") ? shifted["geometry"] : Json::array())
      shift(shift, geometry["boundaries"]);
    lines += Json{{"type", "CityJSONFeature"},
                  {"id", key},
                  {"CityObjects", {{key, shifted}}},
                  {"vertices", vertices}}
                 .dump() +
             "\n";
  }
  const CityModel whole = read_city(write_text(folder / "a.city.json", file.dump()));
  const CityModel model = read_city(write_text(folder / "a.city.jsonl", lines));
  ASSERT_EQ(model.buildings.size(), whole.buildings.size());
  for (const BuildingIndex b : whole.buildings.indices()) {
    EXPECT_EQ(model.buildings[b].source_ids, whole.buildings[b].source_ids);
    // Where a ring begins depends on the numbers of vertices.
    const Ring &a = whole.buildings[b].footprint.outer, &c = model.buildings[b].footprint.outer;
    EXPECT_TRUE(std::is_permutation(a.begin(), a.end(), c.begin(), c.end()));
    EXPECT_EQ(model.buildings[b].h_roof, whole.buildings[b].h_roof);
  }
  const std::string message = testing::error_of(
      [&] { read_city(write_text(folder / "b.city.jsonl", lines.substr(lines.find('\n') + 1))); },
      ErrorKind::kInput);
  EXPECT_NE(message.find("without its first line"), std::string::npos) << message;
}

TEST(CityJson, SolidsWithoutALevelOfDetailHaveAHeight) {
  const TemporaryFolder folder;
  Json file = Json::parse(kTwoParts);
  Json& part = file["CityObjects"]["y"]["geometry"];
  part.erase(0);
  for (const Json& lod : {Json(), Json("x"), Json(true)}) {
    part[0]["lod"] = lod;
    EXPECT_EQ(read_city(write_text(folder / "a.json", file.dump())).buildings.size(), 2U) << lod;
  }
  part[0].erase("lod");
  file["CityObjects"]["a"]["geometry"][0].erase("lod");
  const CityModel model = read_city(write_text(folder / "a.json", file.dump()));
  ASSERT_EQ(model.buildings.size(), 1U);
  EXPECT_EQ(model.buildings[0].h_roof, 9);
  const auto of_surfaces =
      std::find_if(model.dropped.begin(), model.dropped.end(),
                   [](const Dropped& dropped) { return dropped.source_id == "a"; });
  ASSERT_NE(of_surfaces, model.dropped.end());
  EXPECT_NE(of_surfaces->reason.find("'lod'"), std::string::npos) << of_surfaces->reason;
}

TEST(CityJson, ForeignObjectsKeepTheirOrder) {
  const TemporaryFolder folder;
  std::vector<Warning> warnings;
  const CityModel model = read_city(write_text(folder / "a.json", kTwoParts), &warnings);
  EXPECT_EQ(model.crs, "EPSG:28992");
  EXPECT_EQ(model.origin, (Point2{100, 200}));
  ASSERT_EQ(model.buildings.size(), 2U);
  EXPECT_EQ(model.buildings[0].id, "b1");
  EXPECT_EQ(model.buildings[0].source_ids, (std::vector<std::string>{"y"}));
  const Ring expected = {{0.5, 0.25}, {10.5, 0.25}, {10.5, 5.25}, {0.5, 5.25}};
  EXPECT_EQ(model.buildings[0].footprint.outer, expected);
  EXPECT_EQ(model.buildings[0].h_ground, 1);
  EXPECT_EQ(model.buildings[0].h_roof, 9);
  EXPECT_EQ(model.buildings[1].id, "b2");
  EXPECT_EQ(model.buildings[1].source_ids, (std::vector<std::string>{"a"}));
  EXPECT_EQ(model.buildings[1].footprint.outer, expected);  // No floor: the roof's shadow.
  ASSERT_EQ(model.dropped.size(), 2U);
  EXPECT_EQ(model.dropped[0].source_id, "flat");
  EXPECT_EQ(model.dropped[1].source_id, "none");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].count, 2);
}

TEST(CityJson, BrokenDocumentsNameThePlace) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.json";
  const auto mentions = [&](const std::string& text, const char* words) {
    write_text(path, text);
    const std::string message = input_error(path);
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = kTwoParts;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  EXPECT_NE(input_error(folder / "none.json").find("no such file"), std::string::npos);
  input_error(folder.path());
  mentions("", "ends at byte 0");
  mentions("{\"type\":", "ends at byte 8 within its JSON; the file is cut");
  mentions("{x", "not valid JSON after byte 2");
  mentions("PK\3\4", "is packed; unpack it");
  mentions("[]", "not an object");
  mentions("{\"type\":\"FeatureCollection\"}", "/type");
  mentions(changed("\"1.1\"", "\"3.7\""), "/version is \"3.7\"");
  mentions(changed("\"vertices\"", "\"points\""), "vertices");
  mentions(changed("\"CityObjects\"", "\"Objects\""), "CityObjects");
  mentions(changed("[10000,0,1000]", "[10000,0]"), "/vertices/1");
  mentions(changed("[10000,0,1000]", "[10000,0,\"x\"]"), "/vertices/1");
  mentions(changed("[10000,0,1000]", "[1e300,0,0]"), "/vertices/1");
  mentions(changed("[10000,0,1000]", "[1e999,0,0]"), "out of range");
  mentions(changed("[0,3,2,1]", "[0,3,2,8]"), "/CityObjects/y/geometry/1/boundaries/0/0/0/3");
  mentions(changed("[0,3,2,1]", "[0,3,2,-1]"), "is not a vertex number");
  mentions(changed("[0,3,2,1]", "[0,3,2,1.5]"), "is not a vertex number");
  mentions(changed("[[0,3,2,1]]", "0"), "/CityObjects/y/geometry/1/boundaries/0/0 is not an array");
  mentions(changed("[0,null]", "[3,null]"), "has semantics 3 of 1");
  mentions(changed("\"scale\":[0.001,", "\"scale\":["), "/transform/scale");
  mentions(changed("\"type\":\"Solid\",", ""), "has no member 'type'");
  mentions(changed("\"none\"", "\"flat\""), "two members 'flat'");
  mentions(changed("EPSG/0/7415", "EPSG/0/1"), "/metadata/referenceSystem");
  mentions(std::string(100000, '['), "byte");
}

TEST(CityJson, BrokenObjectsOfOthersCostNothingElse) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.json";
  const CityModel sound = read_city(write_text(path, kTwoParts));
  const auto expect_dropped = [&](const Json& file, const char* place) {
    SCOPED_TRACE(place);
    write_text(path, file.dump());
    std::vector<Warning> warnings;
    const CityModel model = read_city(path, &warnings, BrokenObjects::kDrop);
    ASSERT_EQ(model.buildings.size(), 1U);
    EXPECT_EQ(model.buildings[0].source_ids, (std::vector<std::string>{"a"}));
    EXPECT_EQ(model.buildings[0].footprint.outer, sound.buildings[1].footprint.outer);
    EXPECT_EQ(model.buildings[0].h_roof, sound.buildings[1].h_roof);
    EXPECT_EQ(model.origin, sound.origin);
    ASSERT_EQ(model.dropped.size(), 3U);
    EXPECT_EQ(model.dropped[2].source_id, "y");
    EXPECT_TRUE(model.dropped[2].reason.starts_with(place)) << model.dropped[2].reason;
    ASSERT_FALSE(warnings.empty());
    EXPECT_EQ(warnings[0].code, "city_objects_dropped");
    EXPECT_EQ(warnings[0].count, 3);
    // In a file of ours it is damage.
    Json ours = file;
    ours["+tetropolis"] = Json::object();
    write_text(path, ours.dump());
    EXPECT_THROW(read_city(path, nullptr, BrokenObjects::kDrop), Error);
  };
  const Json whole = Json::parse(kTwoParts);
  const auto changed = [&](const char* where, const Json& value) {
    Json file = whole;
    file[Json::json_pointer(where)] = value;
    return file;
  };
  expect_dropped(changed("/CityObjects/y", nullptr), "/CityObjects/y is not an object");
  expect_dropped(changed("/CityObjects/y/geometry", "x"),
                 "/CityObjects/y/geometry is not an array");
  const char* const solid = "/CityObjects/y/geometry/1/boundaries";
  expect_dropped(changed(solid, 1), solid);
  for (const Json& index : {Json(99), Json(-1), Json(1.5), Json(nullptr), Json("x")})
    expect_dropped(changed("/CityObjects/y/geometry/1/boundaries/0/0/0/3", index), solid);
}

TEST(CityJson, FilesThatCannotBeReadAreNamed) {
  const TemporaryFolder folder;
  // An ordinary file by its looks, whose first byte cannot be read.
  fs::create_symlink("/proc/self/mem", folder / "a.json");
  input_error(folder / "a.json");
  ASSERT_EQ(::mkfifo((folder / "pipe.json").c_str(), 0600), 0);
  EXPECT_NE(input_error(folder / "pipe.json").find("ordinary file"), std::string::npos);
}

TEST(CityJson, ChangedBytesNeverCrash) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const TemporaryFolder folder;
  write_city(folder / "good.json", random_city(4));
  const fs::path path = folder / "a.json";
  for (const std::string& good : {std::string(kTwoParts), bytes_of(folder / "good.json")}) {
    const std::string alphabet = "0123456789-.e[]{},:\"nulabx";
    for (int round = 0; round < 400; ++round) {
      std::string text = good;
      for (int k = 0; k < 2; ++k)
        text[random() % text.size()] = alphabet[random() % alphabet.size()];
      write_text(path, text);
      try {
        read_city(path);
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace tetropolis
