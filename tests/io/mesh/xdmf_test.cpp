#include "tetropolis/io/mesh/xdmf.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tetropolis/core/threads.h"

#include "mesh_bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::bytes_of;

/// An HDF5 dataset as it lies in the file.
template <typename Number>
struct Dataset {
  std::vector<hsize_t> shape;
  std::vector<Number> values;
};

template <typename Number>
Dataset<Number> read_dataset(const std::filesystem::path& path, const std::string& name,
                             hid_t type) {
  Dataset<Number> result;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  EXPECT_GE(set, 0) << name;
  if (set < 0) return result;
  const hid_t space = H5Dget_space(set);
  const hid_t stored = H5Dget_type(set);
  EXPECT_GT(H5Tequal(stored, type), 0) << name;
  result.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, result.shape.data(), nullptr);
  result.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  EXPECT_GE(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data()), 0);
  H5Tclose(stored);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
  return result;
}

class Xdmf : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
  const testing::FormatsCity& city = testing::formats_city();

  void SetUp() override {
    write_xdmf(folder / "volume.xdmf", folder / "boundary.xdmf", city.city.mesh, city.boundary,
               city.placement);
  }
  static const char* file_of(const std::string& name) {
    return name.starts_with("/MeshTags") ? "boundary.h5" : "volume.h5";
  }
  Dataset<double> doubles(const std::string& name) {
    return read_dataset<double>(folder / file_of(name), name, H5T_IEEE_F64LE);
  }
  Dataset<std::int64_t> longs(const std::string& name) {
    return read_dataset<std::int64_t>(folder / file_of(name), name, H5T_STD_I64LE);
  }
  Dataset<std::int32_t> ints(const std::string& name) {
    return read_dataset<std::int32_t>(folder / file_of(name), name, H5T_STD_I32LE);
  }
};

TEST_F(Xdmf, VolumeComesBackThroughHdf5) {
  const auto reference = testing::explicit_mesh(city.city.mesh, city.placement.shift);
  const auto points = doubles("/Mesh/mesh/geometry");
  EXPECT_EQ(points.shape, (std::vector<hsize_t>{reference.points.size(), 3}));
  std::vector<double> expected_points;
  for (const auto& p : reference.points)
    expected_points.insert(expected_points.end(), p.begin(), p.end());
  EXPECT_EQ(points.values, expected_points);
  const auto cells = longs("/Mesh/mesh/topology");
  EXPECT_EQ(cells.shape, (std::vector<hsize_t>{reference.cells.size(), 4}));
  std::vector<std::int64_t> expected_cells;
  for (const auto& c : reference.cells)
    expected_cells.insert(expected_cells.end(), c.begin(), c.end());
  EXPECT_EQ(cells.values, expected_cells);
  const auto region = ints("/Mesh/mesh/region");
  EXPECT_EQ(region.shape, (std::vector<hsize_t>{reference.cells.size()}));
  EXPECT_EQ(region.values, reference.region);
}

TEST_F(Xdmf, BoundaryIsOverTheNodesOfTheVolume) {
  const auto points = doubles("/Mesh/mesh/geometry").values;
  const auto faces = longs("/MeshTags/boundary/topology");
  const auto patch = ints("/MeshTags/boundary/patch").values;
  const auto building = ints("/MeshTags/boundary/building").values;
  const auto corners = testing::corners_of(city.boundary, city.placement.shift);
  ASSERT_EQ(faces.shape, (std::vector<hsize_t>{corners.size(), 3}));
  ASSERT_EQ(patch.size(), corners.size());
  ASSERT_EQ(building.size(), city.boundary.building.size());
  EXPECT_TRUE(std::equal(building.begin(), building.end(), city.boundary.building.begin()));
  for (std::size_t f = 0; f < corners.size(); ++f) {
    ASSERT_EQ(patch[f], static_cast<std::int32_t>(city.boundary.patch[f]));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_EQ(points.at(static_cast<std::size_t>(faces.values[3 * f + i]) * 3 + c),
                  corners[f][i][c]);
  }
}

/// The names of the elements in the first grid, without what is in them.
std::vector<std::string> sections_of(const std::string& text) {
  std::vector<std::string> sections;
  for (std::size_t at = text.find("\n<"); at != std::string::npos; at = text.find("\n<", at + 1)) {
    const std::string name = text.substr(at + 2, text.find_first_of(" >", at) - at - 2);
    if (name != "DataItem" && name != "map" && !name.starts_with("/")) sections.push_back(name);
  }
  return sections;
}

TEST_F(Xdmf, DescriptionsFitTheData) {
  int items = 0;
  for (const std::string name : {"volume", "boundary"}) {
    const std::string text = bytes_of(folder / (name + ".xdmf"));
    EXPECT_NE(text.find("<!-- origin 319000 6396000 0 -->\n"), std::string::npos);
    testing::Cursor rest(text);
    for (; text.find("<DataItem", text.size() - rest.left()) != std::string::npos; ++items) {
      rest.until("<DataItem NumberType=\"");
      const std::string number = rest.until("\" Precision=\"");
      const std::string precision = rest.until("\" Dimensions=\"");
      const std::string dimensions = rest.until("\" Format=\"HDF\">");
      const std::string file = rest.until(":");
      const std::string dataset = rest.until("</DataItem>");
      EXPECT_EQ(file, file_of(dataset));
      std::vector<hsize_t> shape;
      if (number == "Float")
        shape = doubles(dataset).shape;
      else
        shape = precision == "8" ? longs(dataset).shape : ints(dataset).shape;
      std::string expected;
      for (const hsize_t n : shape) expected += (expected.empty() ? "" : " ") + std::to_string(n);
      EXPECT_EQ(dimensions, expected) << dataset;
    }
  }
  EXPECT_EQ(items, 7);  // the points serve both grids
  for (const char* file : {"volume.h5", "boundary.h5"})
    EXPECT_EQ(read_dataset<double>(folder / file, "/origin", H5T_IEEE_F64LE).values,
              (std::vector<double>{319000, 6396000, 0}));
  EXPECT_EQ(read_xdmf_origin(folder / "boundary.xdmf"), (Point3{319000, 6396000, 0}));
}

TEST_F(Xdmf, DescriptionsHaveNothingThatEndsMeshio) {
  // One grid in the domain; in the grid nothing but these, and an Information with keys.
  using Sections = std::vector<std::string>;
  const std::string volume = bytes_of(folder / "volume.xdmf");
  EXPECT_EQ(sections_of(volume), (Sections{"!DOCTYPE", "!--", "Xdmf", "Domain", "Grid", "Topology",
                                           "Geometry", "Attribute"}));
  const std::string boundary = bytes_of(folder / "boundary.xdmf");
  EXPECT_EQ(sections_of(boundary),
            (Sections{"!DOCTYPE", "!--", "Xdmf", "Domain", "Grid", "Topology", "Geometry",
                      "Attribute", "Attribute", "Information"}));
  EXPECT_NE(boundary.find("<Information Name=\"patches\" Value=\"8\"><![CDATA[<main>\n"
                          "<map key=\"ground\" dim=\"2\">1</map>\n"),
            std::string::npos);
  // DOLFINx finds grids by these names and takes the first attribute of one it reads tags from.
  EXPECT_NE(volume.find("<Grid Name=\"mesh\" GridType=\"Uniform\">"), std::string::npos);
  EXPECT_NE(boundary.find("<Grid Name=\"boundary\" GridType=\"Uniform\">"), std::string::npos);
  EXPECT_LT(boundary.find("Name=\"patch\""), boundary.find("Name=\"building\""));
}

TEST_F(Xdmf, CompressedDataAreTheSame) {
  // Fine enough for several chunks.
  const auto fine = testing::meshed(testing::small_city(testing::hills), 3);
  const SurfaceMesh boundary = extract_boundary(fine.mesh);
  ASSERT_GT(cell_offsets(fine.mesh).back(), 100000);
  write_xdmf(folder / "plain.xdmf", folder / "plain_boundary.xdmf", fine.mesh, boundary,
             city.placement);
  std::string bytes;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    write_xdmf(folder / "z.xdmf", folder / "z_boundary.xdmf", fine.mesh, boundary, city.placement,
               {}, Compression::kZlib);
    if (threads == 1) bytes = bytes_of(folder / "z.h5");
  }
  EXPECT_TRUE(bytes_of(folder / "z.h5") == bytes);
  EXPECT_LT(3 * bytes.size(), std::filesystem::file_size(folder / "plain.h5"));
  const auto same = [&](auto number, const char* name, hid_t type) {
    using Number = decltype(number);
    const std::string end = name[5] == 'T' ? "_boundary.h5" : ".h5";  // /MeshTags
    const auto a = read_dataset<Number>(folder / ("plain" + end), name, type);
    const auto b = read_dataset<Number>(folder / ("z" + end), name, type);
    EXPECT_EQ(a.shape, b.shape) << name;
    EXPECT_TRUE(a.values == b.values) << name;
  };
  same(0.0, "/Mesh/mesh/geometry", H5T_IEEE_F64LE);
  same(std::int64_t{0}, "/Mesh/mesh/topology", H5T_STD_I64LE);
  same(std::int32_t{0}, "/Mesh/mesh/region", H5T_STD_I32LE);
  same(std::int64_t{0}, "/MeshTags/boundary/topology", H5T_STD_I64LE);
  same(std::int32_t{0}, "/MeshTags/boundary/patch", H5T_STD_I32LE);
  same(std::int32_t{0}, "/MeshTags/boundary/building", H5T_STD_I32LE);
}

TEST_F(Xdmf, SameBytesAtAnotherTime) {
  const auto bytes = [&] {
    return std::pair(bytes_of(folder / "volume.h5"), bytes_of(folder / "boundary.h5"));
  };
  const auto before = bytes();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 would store seconds
  SetUp();
  EXPECT_TRUE(bytes() == before);
}

TEST_F(Xdmf, NamesThatLeaveNoneForTheDataAreRefused) {
  const auto refused = [&](const char* volume, const char* boundary) -> std::string {
    return testing::error_of(
        [&] { write_xdmf(folder / volume, folder / boundary, city.city.mesh, city.boundary, {}); },
        ErrorKind::kInput);
  };
  EXPECT_NE(refused("mesh.h5", "b.xdmf").find("mesh.h5: that name is for the"), std::string::npos);
  EXPECT_NE(refused("a.xdmf", "b.h5").find("b.h5: that name is for the"), std::string::npos);
  EXPECT_NE(refused("a.xdmf", "a.xmf").find("it needs another name than the volume"),
            std::string::npos);
  std::filesystem::create_directory(folder / "other");
  EXPECT_NE(refused("a.xdmf", "other/b.xdmf").find("in the same folder"), std::string::npos);
}

TEST_F(Xdmf, SmallMeshesComeBackToo) {
  for (const double size : {15.0, 25.0, 40.0, 80.0}) {
    testing::SmallCity terrain = testing::small_city(testing::hills);
    terrain.footprints.clear();
    terrain.roofs.clear();
    const ColumnMesh mesh = testing::meshed(terrain, size).mesh;
    write_xdmf(folder / "volume.xdmf", folder / "boundary.xdmf", mesh, extract_boundary(mesh), {});
    const auto reference = testing::explicit_mesh(mesh, {});
    EXPECT_EQ(doubles("/Mesh/mesh/geometry").values.size(), 3 * reference.points.size());
    EXPECT_EQ(ints("/Mesh/mesh/region").values, reference.region);
    const auto patch = ints("/MeshTags/boundary/patch").values;
    EXPECT_EQ(patch.front(), static_cast<std::int32_t>(Patch::kGround));
    EXPECT_EQ(patch.back(), static_cast<std::int32_t>(Patch::kYMax));
  }
}

/// Writes where no file may be larger than `bytes`; leaves with 3 if that was told as it should be.
[[noreturn]] void write_limited(const std::filesystem::path& path, rlim_t bytes,
                                Compression compression) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
  const testing::FormatsCity& city = testing::formats_city();
  try {
    write_xdmf(path, path.parent_path() / "edge.xdmf", city.city.mesh, city.boundary, {}, {},
               compression);
  } catch (const Error& error) {
    const bool named =
        std::string(error.what()).find("full.h5: File too large") != std::string::npos;
    std::exit(named && !std::filesystem::exists(path) ? 3 : 1);
  }
  std::exit(0);
}

TEST_F(Xdmf, NoRoomForTheDataIsAnErrorAndNoCrashAtExit) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  for (const Compression compression : {Compression::kNone, Compression::kZlib}) {
    write_xdmf(folder / "whole.xdmf", folder / "rim.xdmf", city.city.mesh, city.boundary, {}, {},
               compression);
    const rlim_t needed = std::filesystem::file_size(folder / "whole.h5");
    for (rlim_t part = 0; part < 4; ++part) {
      SCOPED_TRACE(part);
      EXPECT_EXIT(write_limited(folder / "full.xdmf", 100 + part * (needed - 101) / 3, compression),
                  ::testing::ExitedWithCode(3), "");
    }
  }
}

TEST_F(Xdmf, EmptyBoundaryIsNoTrouble) {
  for (const Compression compression : {Compression::kNone, Compression::kZlib}) {
    write_xdmf(folder / "open.xdmf", folder / "none.xdmf", city.city.mesh, {}, {}, {}, compression);
    const auto faces = read_dataset<std::int64_t>(folder / "none.h5", "/MeshTags/boundary/topology",
                                                  H5T_STD_I64LE);
    EXPECT_EQ(faces.shape, (std::vector<hsize_t>{0, 3}));
  }
}

TEST_F(Xdmf, WhatIsReadIsWhatWasWritten) {
  const auto reference = testing::explicit_mesh(city.city.mesh, city.placement.shift);
  const auto corners = testing::corners_of(city.boundary, city.placement.shift);
  for (const Compression compression : {Compression::kNone, Compression::kZlib}) {
    write_xdmf(folder / "read.xdmf", folder / "read_boundary.xdmf", city.city.mesh, city.boundary,
               city.placement, {}, compression);
    const auto volume = std::get<TetMesh>(read_xdmf(folder / "read.xdmf"));
    EXPECT_EQ(volume.points, reference.points);
    EXPECT_EQ(volume.cells, reference.cells);
    EXPECT_EQ(volume.region, reference.region);
    const auto boundary = std::get<SurfaceMesh>(read_xdmf(folder / "read_boundary.xdmf"));
    EXPECT_EQ(boundary.patch, city.boundary.patch);
    EXPECT_EQ(boundary.building, city.boundary.building);
    EXPECT_EQ(testing::corners_of(boundary, {0, 0, 0}), corners);
    EXPECT_EQ(boundary.points.size(), city.boundary.points.size());
  }
}

/// What read_xdmf says of `path`; empty if it reads it.
std::string refusal(const std::filesystem::path& path) {
  return testing::error_of([&] { read_xdmf(path); }, ErrorKind::kInput);
}

TEST_F(Xdmf, CutFilesAreRefused) {
  for (const std::string name : {"boundary", "volume"}) {
    const auto path = folder / (name + ".xdmf"), data_path = folder / (name + ".h5");
    const std::string data = bytes_of(data_path);
    ASSERT_EQ(refusal(path), "");
    for (std::size_t k = 0; k < 40; ++k) {
      const std::size_t bytes = data.size() * k / 40;
      std::ofstream(data_path, std::ios::binary) << data.substr(0, bytes);
      EXPECT_NE(refusal(path).find(name + ".h5: "), std::string::npos) << bytes << " bytes";
    }
    std::filesystem::remove(data_path);
    EXPECT_NE(refusal(path).find(name + ".h5: no such file"), std::string::npos);
  }
  // The points of the boundary are the volume's.
  EXPECT_NE(refusal(folder / "boundary.xdmf").find(".h5: no such file"), std::string::npos);
}

TEST_F(Xdmf, PipesAreRefused) {
  const auto pipe = folder / "pipe.xdmf";  // nobody ever writes to it
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(refusal(pipe).find("pipe.xdmf: is not an ordinary file"), std::string::npos);
  std::filesystem::remove(folder / "volume.h5");
  ASSERT_EQ(::mkfifo((folder / "volume.h5").c_str(), 0600), 0);
  EXPECT_NE(refusal(folder / "volume.xdmf").find("volume.h5: is not an ordinary file"),
            std::string::npos);
}

TEST_F(Xdmf, ForeignDescriptionsAreRefused) {
  auto path = folder / "volume.xdmf";
  std::string text = bytes_of(path);
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string changed = text;
    const std::size_t at = changed.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    changed.replace(at, what.size(), instead);
    std::ofstream(path, std::ios::binary) << changed;
    return refusal(path);
  };
  const auto says = [](const std::string& message, const char* what) {
    return message.find(what) != std::string::npos &&
           message.find("volume.xdmf: ") != std::string::npos;
  };
  const std::string cells = std::to_string(longs("/Mesh/mesh/topology").shape[0]);
  for (const auto& [what, instead] :
       {std::pair<std::string, std::string>{"Dimensions=\"" + cells + " 4\"", "Dimensions=\"1 4\""},
        {"NumberOfElements=\"" + cells + "\"", "NumberOfElements=\"1\""},
        {"Tetrahedron", "Hexahedron"},
        {"XYZ", "XY"},
        {"Center=\"Cell\"", "Center=\"Node\""},
        {"Precision=\"8\"", "Precision=\"4\""},
        {"origin 3", "origin 4"}})
    EXPECT_TRUE(
        says(with(what, instead), "does not describe the data that volume.h5 has, from line"))
        << what;
  EXPECT_TRUE(says(with("volume.h5:/Mesh/mesh/geometry", "../volume.h5:/Mesh/mesh/geometry"),
                   "another folder"));
  EXPECT_TRUE(says(with(text, ""), "does not refer to"));
  EXPECT_EQ(with("mesh", "mesh"), "");
  path = folder / "boundary.xdmf";
  text = bytes_of(path);
  for (const auto& [what, instead] :
       {std::pair<std::string, std::string>{"/MeshTags/boundary/patch",
                                            "/MeshTags/boundary/building"},
        {"dim=\"2\"", "dim=\"1\""}})
    EXPECT_NE(
        with(what, instead).find("does not describe the data that boundary.h5 has, from line"),
        std::string::npos)
        << what;
  EXPECT_EQ(with("\"roof\"", "\"dach\""), "");
}

TEST_F(Xdmf, NumbersOutOfRangeAreRefused) {
  const auto with = [&](const char* name, hid_t type, const auto& change) {
    SetUp();
    const auto data = folder / file_of(name);
    const hid_t file = H5Fopen(data.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    std::vector<std::int64_t> values(4 * static_cast<std::size_t>(city.city.mesh.node_count()) * 8);
    H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    change(values.data());
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Fclose(file);
    return refusal(std::filesystem::path(data).replace_extension(".xdmf"));
  };
  const auto nodes = static_cast<std::int64_t>(city.city.mesh.node_count());
  EXPECT_NE(with("/Mesh/mesh/topology", H5T_STD_I64LE, [&](std::int64_t* v) { v[5] = nodes; })
                .find("row 1 of /Mesh/mesh/topology has the vertex " + std::to_string(nodes)),
            std::string::npos);
  EXPECT_NE(with("/MeshTags/boundary/topology", H5T_STD_I64LE, [](std::int64_t* v) { v[0] = -1; })
                .find("row 0 of /MeshTags/boundary/topology has the vertex -1"),
            std::string::npos);
  EXPECT_NE(with("/MeshTags/boundary/patch", H5T_STD_I64LE, [](std::int64_t* v) { v[2] = 0; })
                .find("face 2 has the patch 0"),
            std::string::npos);
}

TEST_F(Xdmf, DataOfAnotherLayoutAreRefused) {
  const auto path = folder / "volume.xdmf";
  const auto with = [&](const char* name, hid_t type, std::vector<hsize_t> shape) {
    SetUp();
    const hid_t file = H5Fopen((folder / "volume.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, name, H5P_DEFAULT);
    if (!shape.empty()) {
      const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
      H5Dclose(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      H5Sclose(space);
    }
    H5Fclose(file);
    return refusal(path);
  };
  const char* kRegion = "/Mesh/mesh/region";
  EXPECT_NE(with(kRegion, H5T_STD_I32LE, {}).find("has no dataset /Mesh/mesh/region"),
            std::string::npos);
  EXPECT_NE(with(kRegion, H5T_STD_I16LE, {10}).find("has another type"), std::string::npos);
  EXPECT_NE(with(kRegion, H5T_STD_I32LE, {10, 2}).find("has another shape"), std::string::npos);
  EXPECT_NE(with(kRegion, H5T_STD_I32LE, {10}).find("not as many regions as cells"),
            std::string::npos);
  // Rows by the trillion that were never written: no room is made for them.
  EXPECT_NE(with(kRegion, H5T_STD_I32LE, {hsize_t{1} << 42}).find("has fewer bytes in the file"),
            std::string::npos);
}

}  // namespace
}  // namespace tetropolis
