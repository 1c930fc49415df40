// What holds for every mesh format.
#include "tetropolis/io/mesh/mesh_formats.h"

#include <fstream>
#include <functional>
#include <map>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "mesh_bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;

using Write = std::function<void(const fs::path&, const Progress&)>;

/// Writers by the name of their file or folder.
std::map<std::string, Write> volume_writers() {
  const auto& city = testing::formats_city();
  static const CellZones no_zones;
  std::map<std::string, Write> writers;
  for (const auto& [name, format] :
       std::map<std::string, std::string>{{"volume.vtu", "vtu"},
                                          {"volume.xdmf", "xdmf"},
                                          {"volume.msh", "msh"},
                                          {"volume_msh2.msh", "msh2"},
                                          {"volume.vtkhdf", "vtkhdf"},
                                          {"volume.cgns", "cgns"},
                                          {"volume_fluent.msh", "fluent"},
                                          {"volume.su2", "su2"},
                                          {"polyMesh", "openfoam"}})
    writers[name] = [&city, format = format](const fs::path& path, const Progress& progress) {
      const VolumeFiles files(city.city.mesh, city.boundary, no_zones, {}, {city.placement});
      EXPECT_TRUE(files.write(format, path, progress));
    };
  return writers;
}

std::map<std::string, Write> all_writers() {
  const auto& city = testing::formats_city();
  auto writers = volume_writers();
  for (const std::string format : {"vtp", "stl", "obj", "ply", "glb"})
    writers["surface." + format] = [&city, format](const fs::path& path, const Progress&) {
      EXPECT_TRUE(write_surface(format, path, city.boundary, {}, {city.placement}));
    };
  return writers;
}

/// All files below a folder with their bytes.
std::map<std::string, std::string> content_of(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      content[fs::relative(entry.path(), folder)] = testing::bytes_of(entry.path());
  return content;
}

TEST(MeshFormats, OfOtherNamesWriteNothing) {
  const auto& city = testing::formats_city();
  const CellZones no_zones;
  const testing::TemporaryFolder folder;
  for (const char* format : {"", "VTU", "doc", "html"}) {
    const VolumeFiles files(city.city.mesh, city.boundary, no_zones, {}, {city.placement});
    EXPECT_FALSE(files.write(format, folder / "mesh"));
    EXPECT_FALSE(write_surface(format, folder / "mesh", city.boundary, {}, {city.placement}));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  EXPECT_EQ(boundary_beside("a/volume_2.xdmf"), "a/boundary_2.xdmf");
  EXPECT_EQ(boundary_beside("a/city.xdmf"), "a/city_boundary.xdmf");
}

TEST(MeshFormats, RefuseOwnPatchesThatAreNotSorted) {
  const auto& city = testing::formats_city();
  const CellZones no_zones;
  SurfaceMesh own = city.boundary;
  const Patch yard{100};
  own.patches.add({yard, "yard", PatchKind::kGround});
  own.patch.front() = yard;
  const testing::TemporaryFolder folder;
  const VolumeFiles files(city.city.mesh, own, no_zones, {}, {city.placement});
  for (const char* format : {"xdmf", "msh", "msh2", "cgns", "fluent", "su2", "openfoam"}) {
    const auto write = [&] { EXPECT_TRUE(files.write(format, folder / format)); };
    EXPECT_NE(testing::error_of(write, ErrorKind::kUsage).find("call sort_by_patch"),
              std::string::npos)
        << format;
  }
  sort_by_patch(own);
  for (const char* format : {"xdmf", "msh", "msh2", "cgns", "fluent", "su2", "openfoam"})
    EXPECT_TRUE(files.write(format, folder / format));
}

TEST(MeshFormats, SameBytesWhateverTheThreads) {
  std::map<std::string, std::string> first;
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    const testing::TemporaryFolder folder;
    for (const auto& [name, write] : all_writers()) write(folder / name, {});
    auto content = content_of(folder.path());
    EXPECT_EQ(content.size(), 21U);
    if (first.empty()) first = content;
    for (const auto& [name, bytes] : content)
      EXPECT_TRUE(first[name] == bytes) << name << " with " << threads << " threads";
  }
}

TEST(MeshFormats, CancelledWritersLeaveNoFile) {
  Progress stop;
  stop.cancelled = [] { return true; };
  for (const auto& [name, write] : volume_writers()) {
    const testing::TemporaryFolder folder;
    EXPECT_THROW(write(folder / name, stop), Cancelled) << name;
    EXPECT_TRUE(content_of(folder.path()).empty()) << name;
  }
}

TEST(MeshFormats, LateCancellationLeavesNoFileEither) {
  for (const auto& [name, write] : volume_writers()) {
    double reached = 0;
    Progress stop;
    stop.report = [&](double fraction) { reached = fraction; };
    stop.cancelled = [&] { return reached > 0.4; };
    const testing::TemporaryFolder folder;
    EXPECT_THROW(write(folder / name, stop), Cancelled) << name;
    EXPECT_TRUE(content_of(folder.path()).empty()) << name;
  }
}

TEST(MeshFormats, ProgressNeverRunsBackwards) {
  for (const auto& [name, write] : volume_writers()) {
    const testing::TemporaryFolder folder;
    double reached = 0;
    Progress progress;
    progress.report = [&, &name = name](double fraction) {
      EXPECT_GE(fraction, reached) << name;
      EXPECT_LE(fraction, 1) << name;
      reached = fraction;
    };
    write(folder / name, progress);
    EXPECT_GT(reached, 0.4) << name;
  }
}

TEST(MeshFormats, UnwritablePlacesAreNamed) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  for (const auto& [name, write] : all_writers()) {
    const fs::path path = folder / "file" / name;
    const std::string text =
        testing::error_of([&, &write = write] { write(path, {}); }, ErrorKind::kInput);
    EXPECT_NE(text.find("cannot write " + (folder / "file").string()), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace tetropolis
