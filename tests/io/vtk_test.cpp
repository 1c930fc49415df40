#include "tetropolis/io/vtk.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/stl.h"

#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The message of the Error that `call` throws.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    return error.what();
  }
  return "no error";
}

class Vtk : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
  testing::MeshedCity city = testing::meshed(testing::small_city(testing::hills));
};

TEST_F(Vtk, VolumeComesBackAsItWas) {
  const Placement placement{{1000, 2000, 0}, {0, 0, 0}};
  write_vtu(folder / "volume.vtu", city.mesh, placement);
  const TetMesh mesh = read_vtu(folder / "volume.vtu");
  const auto expected = testing::explicit_mesh(city.mesh, {1000, 2000, 0});
  EXPECT_EQ(mesh.points, expected.points);
  EXPECT_EQ(mesh.cells, expected.cells);
  EXPECT_EQ(mesh.region, expected.region);
}

TEST_F(Vtk, SurfaceComesBackAsItWas) {
  const SurfaceMesh surface = extract_boundary(city.mesh, city.city.domain);
  write_vtp(folder / "boundary.vtp", surface, {});
  const SurfaceMesh read = read_vtp(folder / "boundary.vtp");
  EXPECT_EQ(read.points, surface.points);
  EXPECT_EQ(read.triangles, surface.triangles);
  EXPECT_EQ(read.patch, surface.patch);
  EXPECT_EQ(read.building, surface.building);
}

TEST_F(Vtk, HeaderIsTheFormatsXmlAndOffsetsFitTheData) {
  write_vtu(folder / "volume.vtu", city.mesh, {{0, 0, 0}, {319000, 6396000, 0}});
  const std::string bytes = bytes_of(folder / "volume.vtu");
  EXPECT_NE(bytes.find("NumberOfTuples=\"1\" format=\"ascii\">319000 6396000 0</DataArray>"),
            std::string::npos);
  EXPECT_EQ(bytes.substr(bytes.size() - 28), "\n</AppendedData>\n</VTKFile>\n");
  // Following each array's byte count leads to the next offset and finally to the closing tag.
  const std::size_t data = bytes.find('_', bytes.find("<AppendedData")) + 1;
  std::size_t at = bytes.find(" offset=\"");
  std::uint64_t expected = 0;
  int arrays = 0;
  for (; at != std::string::npos && at < data; at = bytes.find(" offset=\"", at + 1), ++arrays) {
    EXPECT_EQ(std::stoull(bytes.substr(at + 9)), expected);
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + data + expected, sizeof size);
    expected += sizeof size + size;
  }
  EXPECT_EQ(arrays, 5);
  EXPECT_EQ(data + expected + 28, bytes.size());
}

TEST_F(Vtk, BrokenFilesAreRefusedWithTheirName) {
  write_vtu(folder / "volume.vtu", city.mesh, {});
  const std::string good = bytes_of(folder / "volume.vtu");
  const auto message = [&](const std::string& bytes) {
    write_bytes(folder / "bad.vtu", bytes);
    return error_of([&] { read_vtu(folder / "bad.vtu"); });
  };
  EXPECT_NE(message("").find("bad.vtu: is not a VTK XML file"), std::string::npos);
  EXPECT_NE(message("solid x").find("is not a VTK XML file"), std::string::npos);
  for (std::size_t cut = 100; cut < good.size(); cut += good.size() / 23) {
    const std::string text = message(good.substr(0, cut));
    EXPECT_NE(text.find("bad.vtu"), std::string::npos) << cut << ": " << text;
  }
  std::string lying = good;
  const std::size_t count = lying.find("NumberOfCells=\"") + 15;
  lying.replace(count, lying.find('"', count) - count, "999999999999");
  EXPECT_NE(message(lying).find("the file is cut"), std::string::npos);
  std::string outside = good;
  const std::size_t data = outside.find('_', outside.find("<AppendedData")) + 1;
  const std::size_t tag = outside.find("Name=\"connectivity\"");
  const auto offset = std::stoull(outside.substr(outside.find("offset=\"", tag) + 8));
  const std::int32_t wrong = 0x7fffffff;
  std::memcpy(outside.data() + data + offset + 8, &wrong, sizeof wrong);
  EXPECT_NE(message(outside).find("cell 0 has the vertex 2147483647"), std::string::npos);
  EXPECT_NE(error_of([&] { read_vtu(folder / "missing.vtu"); }).find("missing.vtu"),
            std::string::npos);
}

TEST_F(Vtk, StlHasOneClosedTaggedSolidPerPatch) {
  const SurfaceMesh surface = extract_boundary(city.mesh, city.city.domain);
  write_stl(folder / "surface.stl", surface, {});
  std::ifstream file(folder / "surface.stl");
  std::string word;
  std::vector<std::string> solids;
  std::map<std::pair<std::string, std::string>, int> directed;
  std::vector<std::string> corners;
  std::size_t facets = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "solid") {
      words >> word;
      solids.push_back(word);
    } else if (word == "vertex") {
      corners.push_back(line);
    } else if (word == "endfacet") {
      ASSERT_EQ(corners.size(), 3U);
      for (std::size_t i = 0; i < 3; ++i) ++directed[{corners[i], corners[(i + 1) % 3]}];
      corners.clear();
      ++facets;
    }
  }
  EXPECT_EQ(facets, surface.triangles.size());
  EXPECT_EQ(solids, (std::vector<std::string>{"ground", "roof", "wall", "top", "xmin", "xmax",
                                              "ymin", "ymax"}));
  // Watertight in the printed coordinates: every directed edge once, and its reverse too.
  for (const auto& [edge, count] : directed) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(directed.contains({edge.second, edge.first}));
  }
}

}  // namespace
}  // namespace tetropolis
