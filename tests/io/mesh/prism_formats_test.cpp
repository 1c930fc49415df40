// Meshes with prisms: what files hold of them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/io/mesh/msh.h"
#include "tetropolis/io/mesh/openfoam.h"
#include "tetropolis/io/mesh/su2.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/volume/column/explicit_mesh.h"
#include "tetropolis/volume/quality/prism_quality.h"

#include "mesh_bytes.h"
#include "support/prism_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

class PrismFormats : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
  ColumnMesh mesh =
      testing::prism_city(testing::small_city(testing::hills), 12, {3, 0.5, 1.2}).mesh;
  SurfaceMesh boundary = extract_boundary(mesh);
};

TEST_F(PrismFormats, VtkComesBackAsItWas) {
  for (const Compression compression : {Compression::kNone, Compression::kZlib}) {
    write_vtu(folder / "volume.vtu", mesh, {}, {}, compression);
    const TetMesh read = read_vtu(folder / "volume.vtu");
    const auto tets = testing::explicit_mesh(mesh);
    std::vector<Point3> points(static_cast<std::size_t>(mesh.node_count()));
    fill_points(mesh, {0, 0, 0}, points);
    EXPECT_EQ(read.points, points);
    EXPECT_EQ(read.cells, tets.cells);
    ASSERT_EQ(std::ssize(read.wedges), mesh.layers.cells());
    for (std::size_t w = 0; w < read.wedges.size(); ++w)
      for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(read.wedges[w][i], wedge(mesh, static_cast<std::int64_t>(w))[i].value());
    std::vector<std::int32_t> regions = tets.region;
    regions.resize(read.cell_count(), -1);
    EXPECT_EQ(read.region, regions);

    write_vtp(folder / "boundary.vtp", boundary, {}, compression);
    const SurfaceMesh surface = read_vtp(folder / "boundary.vtp");
    EXPECT_EQ(surface.points, boundary.points);
    EXPECT_EQ(surface.triangles, boundary.triangles);
    EXPECT_EQ(surface.quads, boundary.quads);
    EXPECT_EQ(surface.patch, boundary.patch);
    EXPECT_EQ(surface.building, boundary.building);
  }
}

TEST_F(PrismFormats, SurfacesToLookAtHaveTrianglesOnly) {
  const SurfaceMesh surface = city_surface(boundary);
  EXPECT_TRUE(surface.quads.empty());
  const std::vector<Patch> solid = boundary.patches.solid();
  EXPECT_EQ(surface.triangles.size(),
            static_cast<std::size_t>(
                std::count_if(boundary.patch.begin(), boundary.patch.end(), [&](Patch patch) {
                  return std::find(solid.begin(), solid.end(), patch) != solid.end();
                })));
}

TEST_F(PrismFormats, XdmfComesBackAsVtk) {
  write_vtu(folder / "volume.vtu", mesh, {});
  write_vtp(folder / "boundary.vtp", boundary, {});
  const TetMesh expected = read_vtu(folder / "volume.vtu");
  const SurfaceMesh faces = read_vtp(folder / "boundary.vtp");
  for (const Compression compression : {Compression::kNone, Compression::kZlib}) {
    write_xdmf(folder / "volume.xdmf", folder / "boundary.xdmf", mesh, boundary, {}, {},
               compression);
    const auto volume = std::get<TetMesh>(read_xdmf(folder / "volume.xdmf"));
    EXPECT_GT(volume.wedges.size(), 100U);
    EXPECT_EQ(volume.points, expected.points);
    EXPECT_EQ(volume.cells, expected.cells);
    EXPECT_EQ(volume.wedges, expected.wedges);
    EXPECT_EQ(volume.region, expected.region);
    const auto read = std::get<SurfaceMesh>(read_xdmf(folder / "boundary.xdmf"));
    EXPECT_GT(read.quads.size(), 10U);
    EXPECT_EQ(read.quads, faces.quads);
    EXPECT_EQ(read.patch, faces.patch);
    EXPECT_EQ(read.building, faces.building);
    ASSERT_EQ(read.triangles.size(), faces.triangles.size());
    for (std::size_t f = 0; f < read.triangles.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(read.points[static_cast<std::size_t>(read.triangles[f][i])],
                  faces.points[static_cast<std::size_t>(faces.triangles[f][i])]);
  }
}

TEST_F(PrismFormats, BrokenXdmfIsRefused) {
  write_xdmf(folder / "volume.xdmf", folder / "boundary.xdmf", mesh, boundary, {});
  const std::string whole = testing::bytes_of(folder / "volume.xdmf");
  const auto tets = cell_offsets(mesh).back().value();
  const auto change = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
    std::ofstream(folder / "volume.xdmf", std::ios::binary) << text;
    EXPECT_THROW(read_xdmf(folder / "volume.xdmf"), Error) << to;
  };
  change("\"Mixed\"", "\"Wedge\"");
  change("\"Mixed\"", "\"Tetrahedron\"");
  const auto cells = std::to_string(tets + mesh.layers.cells());
  change("NumberOfElements=\"" + cells, "NumberOfElements=\"1" + cells);
  // An element of another type: the first number of the list.
  std::ofstream(folder / "volume.xdmf", std::ios::binary) << whole;
  std::string data = testing::bytes_of(folder / "volume.h5");
  std::string first(8, '\0');
  first[0] = 6;
  const TetMesh read = std::get<TetMesh>(read_xdmf(folder / "volume.xdmf"));
  for (const std::int64_t v : read.cells[0])
    first.append(reinterpret_cast<const char*>(&v), sizeof(v));
  const std::size_t at = data.find(first);
  ASSERT_NE(at, std::string::npos);
  for (const char type : {4, 8, 9}) {
    data[at] = type;
    std::ofstream(folder / "volume.h5", std::ios::binary) << data;
    EXPECT_THROW(read_xdmf(folder / "volume.xdmf"), Error) << int{type};
  }
}

TEST_F(PrismFormats, TextsHaveAllElements) {
  const auto cells = static_cast<std::size_t>(cell_offsets(mesh).back().value());
  const auto prisms = static_cast<std::size_t>(mesh.layers.cells());
  const std::size_t quads = boundary.quads.size();
  const std::size_t triangles = boundary.triangles.size() - 2 * quads;
  ASSERT_GT(quads, 10U);
  const auto lines = [&](const char* name, const std::string& begin) {
    const std::string text = testing::bytes_of(folder / name);
    std::size_t count = 0;
    for (std::size_t at = text.find("\n" + begin); at != std::string::npos;
         at = text.find("\n" + begin, at + 1))
      ++count;
    return count;
  };
  const auto number = [](std::size_t n) { return std::to_string(n); };
  write_su2(folder / "volume.su2", mesh, boundary, {});
  EXPECT_EQ(lines("volume.su2", "NELEM= " + number(cells + prisms) + "\n"), 1U);
  EXPECT_EQ(lines("volume.su2", "13 "), prisms);
  EXPECT_EQ(lines("volume.su2", "5 "), triangles);
  EXPECT_EQ(lines("volume.su2", "9 "), quads);
  write_msh2(folder / "volume_msh2.msh", mesh, boundary, {});
  const std::size_t faces = triangles + quads;
  EXPECT_EQ(lines("volume_msh2.msh", number(faces + cells + prisms) + " 6 2 9 9 "), 1U);
  EXPECT_EQ(lines("volume_msh2.msh", number(faces + cells) + " 4 2 9 9 "), 1U);
}

/// The values of a binary list, after the header of its file or what was before it.
template <typename Number>
std::vector<Number> list_of(testing::Cursor& file, std::size_t components = 1) {
  const std::size_t size = std::stoull(file.line());
  file.expect("(");
  std::vector<Number> values = file.take<Number>(size * components);
  file.expect(")\n");
  return values;
}

TEST_F(PrismFormats, OpenFoamHasClosedCellsOfTheSameVolume) {
  write_openfoam(folder / "polyMesh", mesh, boundary, {});
  const auto open = [&](const char* name) {
    testing::Cursor file(folder / "polyMesh" / name);
    file.until("}\n\n");
    return file;
  };
  testing::Cursor points_file = open("points"), faces_file = open("faces");
  testing::Cursor owner_file = open("owner"), neighbour_file = open("neighbour");
  const std::vector<double> xyz = list_of<double>(points_file, 3);
  const auto begins = list_of<std::int32_t>(faces_file);
  const auto corners = list_of<std::int32_t>(faces_file);
  const auto owner = list_of<std::int32_t>(owner_file);
  const auto neighbour = list_of<std::int32_t>(neighbour_file);
  ASSERT_EQ(begins.size(), owner.size() + 1);
  ASSERT_EQ(static_cast<std::size_t>(begins.back()), corners.size());
  EXPECT_EQ(owner.size() - neighbour.size(), SurfaceFaces(boundary).size());
  const auto tets = static_cast<std::size_t>(cell_offsets(mesh).back().value());
  const std::size_t cells = tets + static_cast<std::size_t>(mesh.layers.cells());
  std::vector<double> volume(cells, 0);
  std::vector<std::array<double, 3>> area(cells, {0, 0, 0});
  std::vector<int> faces(cells, 0);
  for (std::size_t f = 0; f < owner.size(); ++f) {
    const auto begin = static_cast<std::size_t>(begins[f]);
    const auto end = static_cast<std::size_t>(begins[f + 1]);
    ASSERT_TRUE(end - begin == 3 || end - begin == 4);
    const auto at = [&](std::size_t i) {
      const auto p = static_cast<std::size_t>(corners[i]) * 3;
      return Point3{xyz[p], xyz[p + 1], xyz[p + 2]};
    };
    double share = 0;
    Point3 own{};
    for (std::size_t i = begin + 1; i + 1 < end; ++i) {
      const Point3 a = at(begin), b = at(i), c = at(i + 1);
      const auto part = [&](std::size_t d) {
        const std::size_t e = (d + 1) % 3, g = (d + 2) % 3;
        return ((b[e] - a[e]) * (c[g] - a[g]) - (b[g] - a[g]) * (c[e] - a[e])) / 2;
      };
      for (std::size_t d = 0; d < 3; ++d) {
        own[d] += part(d);
        share += part(d) * a[d] / 3;
      }
    }
    const auto add = [&](std::int32_t cell, double sign) {
      const auto c = static_cast<std::size_t>(cell);
      ++faces[c];
      volume[c] += sign * share;
      for (std::size_t d = 0; d < 3; ++d) area[c][d] += sign * own[d];
    };
    add(owner[f], 1);
    if (f >= neighbour.size()) continue;
    EXPECT_LT(owner[f], neighbour[f]);
    add(neighbour[f], -1);
    if (f > 0) {
      EXPECT_LT(std::pair(owner[f - 1], neighbour[f - 1]), std::pair(owner[f], neighbour[f]));
    }
  }
  double prisms = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    EXPECT_GT(volume[c], 0);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(area[c][d], 0, 1e-6);
    const bool is_prism = c >= tets;
    EXPECT_EQ(faces[c], is_prism ? 5 : 4);
    prisms += is_prism ? volume[c] : 0;
  }
  EXPECT_NEAR(prisms / measure_prisms(mesh, 0.5).volume, 1, 1e-9);
}

}  // namespace
}  // namespace tetropolis
