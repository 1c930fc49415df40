// A mesh with a patch that not every city has, through all formats.
#include <algorithm>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/check/check_surface.h"
#include "tetropolis/io/mesh/gltf.h"
#include "tetropolis/io/mesh/msh.h"
#include "tetropolis/io/mesh/obj.h"
#include "tetropolis/io/mesh/openfoam.h"
#include "tetropolis/io/mesh/ply.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/xdmf.h"

#include "mesh_bytes.h"
#include "support/bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr Patch kStreet{9};

/// The ground south of the houses is a region and a patch of its own.
class MorePatches : public ::testing::Test {
 protected:
  MorePatches() {
    const testing::SmallCity city = testing::small_city(testing::hills);
    GroundMesh ground = mesh_ground(city.footprints, city.domain, {8, 25});
    const auto street = RegionIndex(ground.regions.size());
    ground.regions.push_back({RegionKind::kOpenGround, kNoBuilding, 0, kStreet});
    ground.patches.add({kStreet, "street", PatchKind::kGround});
    for (std::size_t t = 0; t < ground.triangles.size(); ++t) {
      const auto& corners = ground.triangles[t];
      if (std::all_of(corners.begin(), corners.end(), [&](VertexIndex v) {
            return ground.vertices[static_cast<std::size_t>(v)].y <= 15;
          }))
        ground.region[t] = street;
    }
    const ColumnPlan plan = testing::plan_of(city, ground, 8, false);
    EdgeGraph edges = build_edge_graph(ground);
    mesh = divide_columns(std::move(ground), std::move(edges), plan);
    place_nodes(mesh, plan);
    require_valid(mesh);
    surface = extract_boundary(mesh);
  }

  std::string text_of(const char* name) const { return testing::bytes_of(folder / name); }
  bool is_in(const char* name, const std::string& text) const {
    return text_of(name).find(text) != std::string::npos;
  }

  testing::TemporaryFolder folder;
  ColumnMesh mesh;
  SurfaceMesh surface;
};

TEST_F(MorePatches, AreClosedAndCheckedByTheirKind) {
  const auto counts = count_by_patch(surface);
  ASSERT_EQ(counts.size(), 9U);
  EXPECT_EQ(counts[8].name, "street");
  EXPECT_GT(counts[8].faces, 10);
  EXPECT_GT(counts[0].faces, 10);
  EXPECT_TRUE(std::is_sorted(surface.patch.begin(), surface.patch.end()));
  const SurfaceCheck check = check_surface(surface);
  EXPECT_TRUE(check.violations.empty()) << check.violations[0].what;
  EXPECT_TRUE(check.closed && check.manifold);
  EXPECT_EQ(check.faces_by_patch, counts);
  SurfaceMesh turned = surface;
  std::swap(turned.triangles.back()[0], turned.triangles.back()[1]);
  EXPECT_EQ(check_surface(turned).violations.at(0).what, "street faces that do not face down");
}

TEST_F(MorePatches, ComeBackByNumberAndName) {
  write_vtp(folder / "boundary.vtp", surface, {});
  write_vtp(folder / "z.vtp", surface, {}, Compression::kZlib);
  write_xdmf(folder / "volume.xdmf", folder / "boundary.xdmf", mesh, surface, {});
  for (const SurfaceMesh& back : {read_vtp(folder / "boundary.vtp"), read_vtp(folder / "z.vtp"),
                                  std::get<SurfaceMesh>(read_xdmf(folder / "boundary.xdmf"))}) {
    EXPECT_EQ(back.patch, surface.patch);
    ASSERT_TRUE(back.patches.contains(kStreet));
    EXPECT_EQ(back.patches.size(), 9U);
    EXPECT_EQ(back.patches.of(kStreet), (PatchInfo{kStreet, "street", PatchKind::kOther}));
    EXPECT_TRUE(check_surface(back).violations.empty());
  }
}

TEST_F(MorePatches, WithoutNamesComeBackByNumber) {
  write_vtp(folder / "boundary.vtp", surface, {});
  std::string bytes = text_of("boundary.vtp");
  bytes.replace(bytes.find("patch_name"), 10, "patch_kind");
  testing::write_bytes(folder / "boundary.vtp", bytes);
  EXPECT_EQ(read_vtp(folder / "boundary.vtp").patches.of(kStreet).name, "patch9");
}

TEST_F(MorePatches, AreInEveryFormat) {
  const auto faces = static_cast<std::size_t>(count_by_patch(surface)[8].faces);
  write_openfoam(folder / "polyMesh", mesh, surface, {});
  const std::string boundary = testing::bytes_of(folder / "polyMesh/boundary");
  const std::size_t street = boundary.find("    street\n");
  ASSERT_NE(street, std::string::npos);
  EXPECT_GT(street, boundary.find("    ymax\n"));
  EXPECT_EQ(boundary.find("type            wall;", street), street + 25) << boundary.substr(street);
  EXPECT_NE(boundary.find("nFaces          " + std::to_string(faces) + ";", street),
            std::string::npos);

  write_msh(folder / "volume.msh", mesh, surface, {});
  EXPECT_TRUE(is_in("volume.msh", "$PhysicalNames\n10\n"));
  EXPECT_TRUE(is_in("volume.msh", "2 9 \"street\"\n3 9 \"air\"\n"));

  const SurfaceMesh land = city_surface(surface);
  EXPECT_EQ(count_by_patch(land)[8].faces, static_cast<std::int64_t>(faces));
  write_stl(folder / "surface.stl", land, {});
  EXPECT_EQ(read_stl(folder / "surface.stl").attribute.back(), 9);
  write_obj(folder / "surface.obj", land, {});
  EXPECT_TRUE(is_in("surface.obj", "g street\n"));
  write_glb(folder / "surface.glb", land, {});
  EXPECT_TRUE(is_in("surface.glb", "\"name\":\"street\""));

  write_ply(folder / "surface.ply", land, {});
  const std::string ply = text_of("surface.ply");
  // Of the last face, after its count and corners.
  ASSERT_EQ(land.patch.back(), kStreet);
  EXPECT_EQ(ply.substr(ply.size() - 8, 4), std::string("\x09\0\0\0", 4));
}

}  // namespace
}  // namespace tetropolis
