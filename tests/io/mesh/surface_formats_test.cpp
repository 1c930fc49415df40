#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/io/mesh/gltf.h"
#include "tetropolis/io/mesh/obj.h"
#include "tetropolis/io/mesh/ply.h"
#include "tetropolis/io/mesh/stl.h"

#include "mesh_bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::bytes_of_numbers;
using testing::Cursor;
using testing::Point3;

class SurfaceFormats : public ::testing::Test {
 protected:
  SurfaceFormats() { surface = city_surface(city.boundary); }
  testing::TemporaryFolder folder;
  const testing::FormatsCity& city = testing::formats_city();
  SurfaceMesh surface;
};

TEST_F(SurfaceFormats, PlyComesBackAsItWas) {
  write_ply(folder / "surface.ply", surface, city.placement);
  Cursor file(folder / "surface.ply");
  file.expect("ply\nformat binary_little_endian 1.0\ncomment origin 319000 6396000 0\n");
  file.expect("element vertex " + std::to_string(surface.points.size()) + "\n");
  file.expect("property double x\nproperty double y\nproperty double z\n");
  file.expect("element face " + std::to_string(surface.triangles.size()) + "\n");
  file.expect(
      "property list uchar int vertex_indices\nproperty int patch\nproperty int building\n");
  file.expect("end_header\n");
  for (const Point3& point : surface.points) {
    const auto p = file.take<Point3>();
    ASSERT_EQ(p, (Point3{point[0] + 1000, point[1] + 2000, point[2]}));
  }
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    ASSERT_EQ(file.take<std::uint8_t>(), 3);
    ASSERT_EQ((file.take<std::array<std::int32_t, 3>>()), surface.triangles[f]);
    ASSERT_EQ(file.take<std::int32_t>(), static_cast<std::int32_t>(surface.patch[f]));
    ASSERT_EQ(file.take<std::int32_t>(), surface.building[f]);
  }
  EXPECT_EQ(file.left(), 0U);
}

TEST_F(SurfaceFormats, StlComesBackInSinglePrecision) {
  write_stl(folder / "surface.stl", surface, city.placement);
  const StlMesh read = read_stl(folder / "surface.stl");
  EXPECT_EQ(read.origin, (Point3{320000, 6398000, 0}));  // whatever the shift
  ASSERT_EQ(read.triangles.size(), surface.triangles.size());
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    ASSERT_EQ(read.attribute[f], static_cast<std::uint16_t>(surface.patch[f]));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_EQ(read.triangles[f][i][c],
                  static_cast<float>(
                      surface.points[static_cast<std::size_t>(surface.triangles[f][i])][c]));
  }
}

TEST_F(SurfaceFormats, StlHasUnitNormalsAndIsAsWatertightAsTheSurface) {
  write_stl(folder / "boundary.stl", city.boundary, {});
  Cursor file(folder / "boundary.stl");
  file.expect("tetropolis origin 0 0 0");
  file.text(80 - 23);
  ASSERT_EQ(file.take<std::uint32_t>(), city.boundary.triangles.size());
  using Corner = std::array<float, 3>;
  std::map<std::pair<Corner, Corner>, int> directed;
  while (file.left() > 0) {
    const auto normal = file.take<Corner>();
    const auto p = file.take<std::array<Corner, 3>>();
    file.take<std::uint16_t>();
    // The sine of the angle by which a side rises out of the plane, to the rounding of the normal.
    const auto rise = [&](std::size_t to) {
      double dot = 0, square = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double side = static_cast<double>(p[to][c]) - static_cast<double>(p[0][c]);
        dot += static_cast<double>(normal[c]) * side;
        square += side * side;
      }
      return dot / std::sqrt(square);
    };
    ASSERT_NEAR(rise(1), 0, 1e-7);
    ASSERT_NEAR(rise(2), 0, 1e-7);
    double length = 0;
    for (const float x : normal) length += static_cast<double>(x) * static_cast<double>(x);
    ASSERT_NEAR(length, 1, 1e-6);
    for (std::size_t i = 0; i < 3; ++i) ++directed[{p[i], p[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : directed) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(directed.contains({edge.second, edge.first}));
  }
}

/// What read_stl says of a file with these bytes; empty if it reads it.
std::string refusal(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  return testing::error_of([&] { read_stl(path); }, ErrorKind::kInput);
}

TEST_F(SurfaceFormats, StlThatIsNotBinaryOrCutIsRefused) {
  const auto path = folder / "some.stl";
  const auto says = [&](const std::string& bytes, const char* what) {
    return refusal(path, bytes).find("some.stl: " + std::string(what)) != std::string::npos;
  };
  write_stl(path, surface, {});
  const std::string bytes = testing::bytes_of(path);
  EXPECT_EQ(refusal(path, bytes), "");
  EXPECT_TRUE(says("", "is too short for binary STL"));
  EXPECT_TRUE(says("solid ground\n", "is ASCII STL; only binary STL can be read"));
  EXPECT_TRUE(says("solid ground\n" + std::string(1000, ' '), "is ASCII STL"));
  EXPECT_TRUE(says(bytes.substr(0, bytes.size() - 1),
                   ("has " + std::to_string(bytes.size() - 1) + " bytes; with its").c_str()));
  // Of another program: no origin, and a header that begins like ASCII.
  EXPECT_EQ(refusal(path, "solid" + bytes.substr(5)), "");
  EXPECT_FALSE(read_stl(path).origin);
}

/// Triangles by patch and building, sorted.
using Groups = std::map<std::pair<std::string, int>, std::vector<std::array<int, 3>>>;

TEST_F(SurfaceFormats, ObjGroupsFacesByPatchAndBuilding) {
  write_obj(folder / "surface.obj", surface, city.placement);
  std::istringstream file(testing::bytes_of(folder / "surface.obj"));
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "# origin 319000 6396000 0");
  std::size_t points = 0;
  Groups groups;
  std::pair<std::string, int> group;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      for (std::size_t c = 0; c < 3; ++c) {
        double x = 0;
        words >> x;
        ASSERT_NEAR(x, surface.points[points][c] + city.placement.shift[c], 0.51e-6);
      }
      ++points;
    } else if (kind == "g") {
      std::string building;
      group.second = kNoBuilding.value();
      words >> group.first;
      if (words >> building) {
        ASSERT_EQ(building.rfind("building_", 0), 0U);
        group.second = std::stoi(building.substr(9));
      }
      ASSERT_FALSE(groups.contains(group)) << "a group is in one piece: " << line;
    } else {
      ASSERT_EQ(kind, "f");
      std::array<int, 3> face{};
      words >> face[0] >> face[1] >> face[2];
      groups[group].push_back(face);
    }
  }
  EXPECT_EQ(points, surface.points.size());
  Groups expected;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& t = surface.triangles[f];
    expected[{surface.patch_of(f).name, surface.building[f].value()}].push_back(
        {t[0] + 1, t[1] + 1, t[2] + 1});
  }
  EXPECT_EQ(groups, expected);
  EXPECT_EQ(groups.size(), 11U);  // the ground, and roof and walls of five buildings
}

struct Glb {
  nlohmann::json json;
  std::string data;
};

Glb read_glb(const std::filesystem::path& path) {
  Cursor file(path);
  const std::size_t size = file.left();
  file.expect("glTF");
  EXPECT_EQ(file.take<std::uint32_t>(), 2U);
  EXPECT_EQ(file.take<std::uint32_t>(), size);
  Glb glb;
  const auto json_size = file.take<std::uint32_t>();
  EXPECT_EQ(json_size % 4, 0U);
  file.expect("JSON");
  glb.json = nlohmann::json::parse(file.text(json_size));
  if (file.left() == 0) return glb;
  const auto data_size = file.take<std::uint32_t>();
  EXPECT_EQ(data_size % 4, 0U);
  file.expect(std::string("BIN\0", 4));
  glb.data = file.text(data_size);
  EXPECT_EQ(file.left(), 0U);
  return glb;
}

/// The numbers of an accessor, after checking that it lies in the buffer.
template <typename Number>
std::vector<Number> accessor_values(const Glb& glb, std::size_t index, std::size_t components) {
  const auto& accessor = glb.json["accessors"].at(index);
  const auto& view = glb.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
  const std::size_t count = accessor["count"].get<std::size_t>() * components;
  EXPECT_EQ(view["byteLength"].get<std::size_t>(), count * sizeof(Number));
  EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
  Cursor data(glb.data);
  data.text(view["byteOffset"].get<std::size_t>());
  return data.take<Number>(count);
}

TEST_F(SurfaceFormats, GlbShowsEachPatch) {
  write_glb(folder / "surface.glb", surface, city.placement);
  const Glb glb = read_glb(folder / "surface.glb");
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_EQ(glb.json["asset"]["extras"]["origin"], (std::vector<double>{320000, 6398000, 0}));
  EXPECT_EQ(glb.json["buffers"].size(), 1U);
  EXPECT_EQ(glb.json["buffers"][0]["byteLength"].get<std::size_t>(), glb.data.size());
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], (std::vector<int>{0, 1, 2}));
  std::set<std::vector<double>> colours;
  std::size_t face = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto& node = glb.json["nodes"][n];
    EXPECT_EQ(node["name"], surface.patches[n].name);
    const auto& primitives = glb.json["meshes"][node["mesh"].get<std::size_t>()]["primitives"];
    ASSERT_EQ(primitives.size(), 1U);
    const auto at = primitives[0]["attributes"]["POSITION"].get<std::size_t>();
    const auto points = accessor_values<float>(glb, at, 3);
    const auto corners =
        accessor_values<std::uint32_t>(glb, primitives[0]["indices"].get<std::size_t>(), 1);
    const auto& material = glb.json["materials"][primitives[0]["material"].get<std::size_t>()];
    colours.insert(material["pbrMetallicRoughness"]["baseColorFactor"].get<std::vector<double>>());
    for (std::size_t c = 0; c < 3; ++c) {
      float low = points[c], high = points[c];
      for (std::size_t i = c; i < points.size(); i += 3) {
        low = std::min(low, points[i]);
        high = std::max(high, points[i]);
      }
      EXPECT_EQ(glb.json["accessors"][at]["min"][c].get<double>(), static_cast<double>(low));
      EXPECT_EQ(glb.json["accessors"][at]["max"][c].get<double>(), static_cast<double>(high));
    }
    for (std::size_t i = 0; i < corners.size(); i += 3, ++face) {
      ASSERT_EQ(surface.patch[face], static_cast<Patch>(n + 1));
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t corner = corners[i + j];
        const Point3& p = surface.points[static_cast<std::size_t>(surface.triangles[face][j])];
        ASSERT_EQ(points.at(3 * corner), static_cast<float>(p[0]));
        ASSERT_EQ(points.at(3 * corner + 1), static_cast<float>(p[2]));
        ASSERT_EQ(points.at(3 * corner + 2), static_cast<float>(-p[1]));
      }
    }
  }
  EXPECT_EQ(face, surface.triangles.size());
  EXPECT_EQ(colours.size(), 3U);
}

/// The bytes of a column of the property table, after checking that it is aligned.
std::string column(const Glb& glb, const char* property, const char* part) {
  const auto& table = glb.json["extensions"]["EXT_structural_metadata"]["propertyTables"][0];
  const auto& view =
      glb.json["bufferViews"].at(table["properties"][property][part].get<std::size_t>());
  EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 8, 0U);
  return glb.data.substr(view["byteOffset"].get<std::size_t>(),
                         view["byteLength"].get<std::size_t>());
}

TEST_F(SurfaceFormats, GlbVerticesBelongToOneBuilding) {
  // Two roofs that share an edge, and ground that no building has.
  SurfaceMesh touching;
  touching.points = {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}, {9, 9, 0}, {9, 8, 0}, {8, 9, 0}};
  touching.triangles = {{4, 5, 6}, {0, 1, 2}, {0, 2, 3}};
  touching.patch = {Patch::kGround, Patch::kRoof, Patch::kRoof};
  touching.building = {kNoBuilding, BuildingIndex(1), BuildingIndex(0)};
  std::vector<Building> buildings(2);
  buildings[0].id = "b0";
  buildings[0].source_ids = {"x", "yz"};
  buildings[0].h_ground = 1;
  buildings[0].h_roof = 5;
  buildings[1].id = "b14";
  buildings[1].source_ids = {"\u00e5"};
  buildings[1].h_ground = -1;
  buildings[1].h_roof = 5;
  write_glb(folder / "touching.glb", touching, {}, buildings);
  const Glb glb = read_glb(folder / "touching.glb");
  const auto& ground = glb.json["meshes"][0]["primitives"][0];
  EXPECT_FALSE(ground.contains("extensions"));
  EXPECT_FALSE(ground["attributes"].contains("_FEATURE_ID_0"));
  EXPECT_EQ(glb.json["nodes"][1]["extras"]["patch"], 2);
  const auto& roof = glb.json["meshes"][1]["primitives"][0];
  const auto features =
      accessor_values<float>(glb, roof["attributes"]["_FEATURE_ID_0"].get<std::size_t>(), 1);
  const auto points =
      accessor_values<float>(glb, roof["attributes"]["POSITION"].get<std::size_t>(), 3);
  const auto corners = accessor_values<std::uint32_t>(glb, roof["indices"].get<std::size_t>(), 1);
  ASSERT_EQ(features.size(), 6U);
  ASSERT_EQ(points.size(), 18U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(features[corners[i]], i < 3 ? 1.0F : 0.0F);
    const auto& p = touching.points[static_cast<std::size_t>(touching.triangles[1 + i / 3][i % 3])];
    EXPECT_EQ(points[3 * corners[i]], static_cast<float>(p[0]));
    EXPECT_EQ(points[3 * corners[i] + 2], static_cast<float>(-p[1]));
  }
  EXPECT_EQ(roof["extensions"]["EXT_mesh_features"]["featureIds"],
            nlohmann::json::parse(R"([{"featureCount": 2, "attribute": 0, "propertyTable": 0}])"));

  const auto& metadata = glb.json["extensions"]["EXT_structural_metadata"];
  EXPECT_EQ(metadata["propertyTables"][0]["class"], "building");
  EXPECT_EQ(metadata["propertyTables"][0]["count"], 2);
  EXPECT_EQ(metadata["schema"]["classes"]["building"]["properties"]["source_ids"]["array"], true);
  EXPECT_EQ(column(glb, "id", "values"), "b0b14");
  EXPECT_EQ(column(glb, "id", "stringOffsets"), bytes_of_numbers<std::uint32_t>({0, 2, 5}));
  EXPECT_EQ(column(glb, "source_ids", "values"), "xyz\u00e5");
  EXPECT_EQ(column(glb, "source_ids", "stringOffsets"),
            bytes_of_numbers<std::uint32_t>({0, 1, 3, 5}));
  EXPECT_EQ(column(glb, "source_ids", "arrayOffsets"), bytes_of_numbers<std::uint32_t>({0, 2, 3}));
  EXPECT_EQ(column(glb, "h_ground", "values"), bytes_of_numbers<double>({1, -1}));
  EXPECT_EQ(column(glb, "h_roof", "values"), bytes_of_numbers<double>({5, 5}));
  EXPECT_EQ(glb.json["extensionsUsed"].size(), 2U);
  // Without buildings it is plain glTF.
  write_glb(folder / "plain.glb", touching, {});
  EXPECT_FALSE(read_glb(folder / "plain.glb").json.contains("extensionsUsed"));
}

TEST_F(SurfaceFormats, GlbOfNothingIsStillAScene) {
  write_glb(folder / "surface.glb", {}, {});
  const Glb glb = read_glb(folder / "surface.glb");
  EXPECT_EQ(glb.json["scenes"].size(), 1U);
  EXPECT_FALSE(glb.json.contains("buffers"));
  EXPECT_TRUE(glb.data.empty());
}

}  // namespace
}  // namespace tetropolis
