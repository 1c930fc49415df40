// What holds for every mesh format.
#include <fstream>
#include <functional>
#include <map>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/io/mesh/gltf.h"
#include "tetropolis/io/mesh/msh.h"
#include "tetropolis/io/mesh/obj.h"
#include "tetropolis/io/mesh/openfoam.h"
#include "tetropolis/io/mesh/ply.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/xdmf.h"

#include "mesh_bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;

using Write = std::function<void(const fs::path&, const Progress&)>;

/// Writers by the name of their file or folder.
std::map<std::string, Write> volume_writers() {
  const auto& city = testing::formats_city();
  const ColumnMesh& mesh = city.city.mesh;
  const SurfaceMesh& boundary = city.boundary;
  const Placement& placement = city.placement;
  return {{"volume.xdmf",
           [&](const fs::path& p, const Progress& progress) {
             write_xdmf(p, p.parent_path() / "boundary.xdmf", mesh, boundary, placement, progress);
           }},
          {"volume.msh",
           [&](const fs::path& p, const Progress& progress) {
             write_msh(p, mesh, boundary, placement, progress);
           }},
          {"polyMesh", [&](const fs::path& p, const Progress& progress) {
             write_openfoam(p, mesh, boundary, placement, progress);
           }}};
}

std::map<std::string, Write> all_writers() {
  const auto& city = testing::formats_city();
  auto writers = volume_writers();
  writers["volume.vtu"] = [&](const fs::path& p, const Progress& progress) {
    write_vtu(p, city.city.mesh, city.placement, progress);
  };
  writers["surface.obj"] = [&](const fs::path& p, const Progress&) {
    write_obj(p, city.boundary, city.placement);
  };
  writers["surface.ply"] = [&](const fs::path& p, const Progress&) {
    write_ply(p, city.boundary, city.placement);
  };
  writers["surface.glb"] = [&](const fs::path& p, const Progress&) {
    write_glb(p, city.boundary, city.placement);
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

TEST(MeshFormats, SameBytesWhateverTheThreads) {
  std::map<std::string, std::string> first;
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    const testing::TemporaryFolder folder;
    for (const auto& [name, write] : all_writers()) write(folder / name, {});
    auto content = content_of(folder.path());
    EXPECT_EQ(content.size(), 14U);
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
    try {
      write(path, {});
      FAIL() << "no error for " << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      const std::string text = error.what();
      EXPECT_NE(text.find("cannot write " + (folder / "file").string()), std::string::npos) << text;
    }
  }
}

}  // namespace
}  // namespace tetropolis
