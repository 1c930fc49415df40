#include "tetropolis/io/mesh/vtk.h"

#include <cmath>
#include <cstdio>
#include <cstring>

#include <gtest/gtest.h>
#include <zlib.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"

#include "io/limited_memory.h"
#include "io/mesh/mesh_input.h"
#include "mesh_bytes.h"
#include "support/bytes.h"
#include "support/errors.h"
#include "support/explicit_mesh.h"
#include "support/sanitized.h"
#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::bytes_of;
using testing::bytes_of_numbers;
using testing::write_bytes;

/// The message of the Error that `call` throws.
template <typename Call>
std::string error_of(const Call& call) {
  return testing::error_of(call, ErrorKind::kInput);
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
  const SurfaceMesh surface = extract_boundary(city.mesh);
  write_vtp(folder / "boundary.vtp", surface, {});
  const SurfaceMesh read = read_vtp(folder / "boundary.vtp");
  EXPECT_EQ(read.points, surface.points);
  EXPECT_EQ(read.triangles, surface.triangles);
  EXPECT_EQ(read.patch, surface.patch);
  EXPECT_EQ(read.building, surface.building);
}

TEST_F(Vtk, CompressedFilesComeBackAsTheyWereAndDoNotDependOnThreads) {
  const Placement placement{{1000, 2000, 0}, {0, 0, 0}};
  const SurfaceMesh surface = extract_boundary(city.mesh);
  std::string volume, boundary;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    write_vtu(folder / "z.vtu", city.mesh, placement, {}, Compression::kZlib);
    write_vtp(folder / "z.vtp", surface, placement, Compression::kZlib);
    if (threads == 1) {
      volume = bytes_of(folder / "z.vtu");
      boundary = bytes_of(folder / "z.vtp");
    }
  }
  EXPECT_TRUE(bytes_of(folder / "z.vtu") == volume);
  EXPECT_TRUE(bytes_of(folder / "z.vtp") == boundary);
  EXPECT_NE(volume.find("compressor=\"vtkZLibDataCompressor\""), std::string::npos);
  write_vtu(folder / "plain.vtu", city.mesh, placement);
  EXPECT_LT(2 * volume.size(), std::filesystem::file_size(folder / "plain.vtu"));
  const TetMesh mesh = read_vtu(folder / "z.vtu");
  const auto expected = testing::explicit_mesh(city.mesh, placement.shift);
  EXPECT_EQ(mesh.points, expected.points);
  EXPECT_EQ(mesh.cells, expected.cells);
  EXPECT_EQ(mesh.region, expected.region);
  const SurfaceMesh read = read_vtp(folder / "z.vtp");
  EXPECT_EQ(read.triangles, surface.triangles);
  EXPECT_EQ(read.patch, surface.patch);
  EXPECT_EQ(read.building, surface.building);
}

/// The bytes of an array of a file without compression.
std::string array_of(const std::string& bytes, const std::string& name) {
  const std::size_t tag = bytes.find(" Name=\"" + name + "\"");
  if (tag == std::string::npos) return "none";
  const auto offset = std::stoull(bytes.substr(bytes.find("offset=\"", tag) + 8));
  const std::size_t at = bytes.find('_', bytes.find("<AppendedData")) + 1 + offset;
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + at, sizeof size);
  return bytes.substr(at + sizeof size, size);
}

TEST_F(Vtk, PatchesAndBuildingsAreNamedInTheFieldData) {
  std::vector<Building> buildings(2);
  buildings[0].id = std::string(
      "b\0"
      "0",
      3);  // without the zero
  buildings[0].source_ids = {"a", "b\"2"};
  buildings[0].h_ground = 1.5;
  buildings[0].h_roof = 9;
  buildings[1].id = "b7";
  buildings[1].source_ids = {"\u00e5"};
  buildings[1].h_ground = -2;
  buildings[1].h_roof = 4;
  const std::string ids("b0\0b7\0", 6),
      sources = "[\"a\",\"b\\\"2\"]" + std::string(1, '\0') + "[\"\u00e5\"]" + std::string(1, '\0');
  const SurfaceMesh surface = extract_boundary(city.mesh);
  write_vtp(folder / "boundary.vtp", surface, {}, Compression::kNone, buildings);
  write_vtu(folder / "volume.vtu", city.mesh, {}, {}, Compression::kNone, buildings);
  const std::string vtp = bytes_of(folder / "boundary.vtp"), vtu = bytes_of(folder / "volume.vtu");
  EXPECT_EQ(array_of(vtp, "patch_number"),
            bytes_of_numbers<std::int32_t>({1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(array_of(vtp, "patch_name"),
            std::string("ground\0roof\0wall\0top\0xmin\0xmax\0ymin\0ymax\0", 41));
  for (const std::string& file : {vtp, vtu}) {
    EXPECT_EQ(array_of(file, "building_id"), ids);
    EXPECT_EQ(array_of(file, "building_source_ids"), sources);
    EXPECT_EQ(array_of(file, "building_h_ground"), bytes_of_numbers<double>({1.5, -2}));
    EXPECT_EQ(array_of(file, "building_h_roof"), bytes_of_numbers<double>({9, 4}));
  }
  EXPECT_NE(vtp.find("<Array type=\"String\" Name=\"building_id\" NumberOfTuples=\"2\""),
            std::string::npos);
  // For meshio, which knows no texts.
  EXPECT_EQ(vtu.find("String"), std::string::npos);
  EXPECT_NE(vtu.find("<DataArray type=\"UInt8\" Name=\"building_id\" NumberOfTuples=\"6\""),
            std::string::npos);
  // All other arrays lie where they do without.
  write_vtu(folder / "bare.vtu", city.mesh, {});
  const std::string bare = bytes_of(folder / "bare.vtu");
  const std::size_t data = bare.find("<AppendedData");
  EXPECT_EQ(vtu.substr(vtu.find("<AppendedData"), bare.size() - 28 - data),
            bare.substr(data, bare.size() - 28 - data));
  // A file cut in the field data, which is not read.
  write_bytes(folder / "cut.vtu", vtu.substr(0, vtu.size() - 30));
  EXPECT_NE(error_of([&] { read_vtu(folder / "cut.vtu"); }).find("closing tag: the file is cut"),
            std::string::npos);
}

/// The first array of a file written here with compression: where its header begins.
std::size_t first_array(const std::string& bytes) {
  return bytes.find('_', bytes.find("<AppendedData")) + 1;
}

TEST_F(Vtk, BlocksOfCompressedArraysUnpackToTheirBytes) {
  // Several blocks and a shorter last one, by the format's description and zlib alone.
  const SurfaceMesh surface = extract_boundary(testing::meshed(city.city, 1.5).mesh);
  write_vtp(folder / "z.vtp", surface, {}, Compression::kZlib);
  const std::string bytes = bytes_of(folder / "z.vtp");
  std::size_t at = first_array(bytes);
  const auto word = [&] {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    return value;
  };
  const std::uint64_t blocks = word(), size = word(), last = word();
  ASSERT_GE(blocks, 2U);
  ASSERT_GT(last, 0U);
  ASSERT_EQ((blocks - 1) * size + last, surface.points.size() * 24);
  std::vector<std::uint64_t> stored;
  for (std::uint64_t b = 0; b < blocks; ++b) stored.push_back(word());
  std::vector<char> unpacked;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    std::vector<char> block(size);
    uLongf length = size;
    ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(block.data()), &length,
                         reinterpret_cast<const Bytef*>(bytes.data()) + at, stored[b]),
              Z_OK);
    ASSERT_EQ(length, b + 1 == blocks ? last : size);
    unpacked.insert(unpacked.end(), block.begin(), block.begin() + static_cast<long>(length));
    at += stored[b];
  }
  EXPECT_EQ(std::memcmp(unpacked.data(), surface.points.data(), unpacked.size()), 0);
  // The offset in the second tag leads to the array behind it.
  const std::size_t tag = bytes.find("Name=\"connectivity\"");
  const auto offset = std::stoull(bytes.substr(bytes.find("offset=\"", tag) + 8));
  EXPECT_EQ(first_array(bytes) + offset, at);
}

TEST_F(Vtk, BrokenCompressedFilesAreRefused) {
  write_vtu(folder / "z.vtu", city.mesh, {}, {}, Compression::kZlib);
  const std::string good = bytes_of(folder / "z.vtu");
  const auto message = [&](const std::string& bytes) {
    write_bytes(folder / "bad.vtu", bytes);
    return error_of([&] { read_vtu(folder / "bad.vtu"); });
  };
  for (std::size_t cut = 100; cut < good.size(); cut += good.size() / 23)
    EXPECT_NE(message(good.substr(0, cut)).find("bad.vtu"), std::string::npos) << cut;
  std::string lying = good;
  const std::uint64_t much = std::uint64_t{1} << 60;
  for (const std::size_t word : {0, 2, 3}) {  // number, size of the last, stored size of the first
    lying = good;
    std::memcpy(lying.data() + first_array(good) + 8 * word, &much, sizeof much);
    EXPECT_NE(message(lying).find("array Points"), std::string::npos) << word << message(lying);
  }
  std::string damaged = good;
  for (std::size_t i = 0; i < 50; ++i) damaged[first_array(good) + 1000 + i] ^= 0x55;
  EXPECT_NE(message(damaged).find("cannot be decompressed: the file"), std::string::npos);
  std::string other = good;
  other.replace(other.find("vtkZLib"), 7, "vtkLZMA");
  EXPECT_NE(message(other).find("vtkLZMADataCompressor"), std::string::npos);
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

TEST_F(Vtk, FilesOfSeveralPiecesAreRefused) {
  write_vtu(folder / "volume.vtu", city.mesh, {});
  std::string bytes = bytes_of(folder / "volume.vtu");
  bytes.insert(bytes.find("</Piece>") + 8,
               "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece>");
  write_bytes(folder / "two.vtu", bytes);
  EXPECT_NE(error_of([&] { read_vtu(folder / "two.vtu"); }).find("two.vtu: has several pieces"),
            std::string::npos);
}

TEST(VtkMemory, SurfacesLargerThanTheMemoryAreRefused) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "the sanitizers need more address space than any limit";
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const testing::TemporaryFolder scratch;
  const auto path = scratch / "large.vtp";
  constexpr std::uint64_t kPoints = 200'000'000;
  const std::uint64_t bytes = kPoints * 24;
  std::string head =
      R"(<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64"><PolyData>)"
      R"(<Piece NumberOfPoints="200000000" NumberOfPolys="0"><Points>)"
      R"(<DataArray type="Float64" Name="Points" format="appended" offset="0"/></Points></Piece>)"
      R"(</PolyData><AppendedData encoding="raw">_)";
  head.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  write_bytes(path, head);
  std::filesystem::resize_file(path, head.size() + bytes);  // a hole, which takes no room
  EXPECT_EXIT(testing::read_in_four_gigabytes([&] { read_vtp(path); }),
              ::testing::ExitedWithCode(3), "large.vtp: to read its 200000000 points");
}

TEST(MeshInput, MeshesLargerThanTheMemoryAreRefused) {
  EXPECT_NO_THROW(require_room_for_mesh("small.vtu", 1000, 5000));
  const std::string message = testing::error_of(
      [&] { require_room_for_mesh("large.vtu", 200'000'000'000, 1'000'000'000'000); },
      ErrorKind::kInput);
  EXPECT_EQ(
      message.find("large.vtu: to read and check its 1000000000000 cells takes about 61600.0 GB"),
      0U)
      << message;
}

}  // namespace
}  // namespace tetropolis
