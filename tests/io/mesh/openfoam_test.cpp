#include "tetropolis/io/mesh/openfoam.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "core/infinity.h"
#include "mesh_bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::Cursor;
using testing::Point3;

struct FoamPatch {
  std::string name, type;
  std::size_t faces = 0, start = 0;
};

struct FoamMesh {
  std::vector<Point3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  std::vector<std::int32_t> owner, neighbour;
  std::vector<FoamPatch> patches;
  std::string points_header, owner_header;
};

/// Reads the header of a file and returns it; the cursor stands before the data.
std::string read_header(Cursor& file, const std::string& type, const std::string& object) {
  std::string header = file.until("}\n\n");
  EXPECT_EQ(header.rfind("FoamFile\n{\n", 0), 0U);
  EXPECT_NE(header.find("class       " + type + ";"), std::string::npos) << header;
  EXPECT_NE(header.find("object      " + object + ";"), std::string::npos) << header;
  return header;
}

template <typename Number>
std::vector<Number> read_list(Cursor& file, std::size_t components = 1) {
  const std::size_t size = std::stoull(file.line());
  file.expect("(");
  std::vector<Number> values = file.take<Number>(size * components);
  file.expect(")\n");
  return values;
}

std::vector<FoamPatch> read_patches(const std::filesystem::path& path) {
  Cursor file(path);
  EXPECT_NE(read_header(file, "polyBoundaryMesh", "boundary").find("format      ascii;"),
            std::string::npos);
  const std::size_t count = std::stoull(file.line());
  file.expect("(\n");
  std::vector<FoamPatch> patches(count);
  for (FoamPatch& patch : patches) {
    std::istringstream(file.line()) >> patch.name;
    file.expect("    {\n");
    std::istringstream body(file.until("    }\n"));
    for (std::string key, value; body >> key >> value;) {
      EXPECT_EQ(value.back(), ';');
      value.pop_back();
      if (key == "type") patch.type = value;
      if (key == "nFaces") patch.faces = std::stoull(value);
      if (key == "startFace") patch.start = std::stoull(value);
    }
  }
  file.expect(")\n");
  EXPECT_EQ(file.left(), 0U);
  return patches;
}

FoamMesh read_foam(const std::filesystem::path& folder) {
  FoamMesh mesh;
  Cursor points(folder / "points");
  mesh.points_header = read_header(points, "vectorField", "points");
  const auto xyz = read_list<double>(points, 3);
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    mesh.points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
  Cursor faces(folder / "faces");
  read_header(faces, "faceCompactList", "faces");
  const auto starts = read_list<std::int32_t>(faces);
  const auto corners = read_list<std::int32_t>(faces);
  for (std::size_t f = 0; f + 1 < starts.size(); ++f) {
    EXPECT_EQ(starts[f + 1] - starts[f], 3);
    const auto at = static_cast<std::size_t>(starts[f]);
    mesh.faces.push_back({corners.at(at), corners.at(at + 1), corners.at(at + 2)});
  }
  EXPECT_EQ(static_cast<std::size_t>(starts.back()), corners.size());
  Cursor owner(folder / "owner");
  mesh.owner_header = read_header(owner, "labelList", "owner");
  mesh.owner = read_list<std::int32_t>(owner);
  Cursor neighbour(folder / "neighbour");
  read_header(neighbour, "labelList", "neighbour");
  mesh.neighbour = read_list<std::int32_t>(neighbour);
  for (const Cursor* file : {&points, &faces, &owner, &neighbour}) EXPECT_EQ(file->left(), 0U);
  mesh.patches = read_patches(folder / "boundary");
  return mesh;
}

/// A face by its ascending corners, and the cells that have it, ascending; -1 for none.
using Shared = std::tuple<std::array<std::int64_t, 3>, std::int64_t, std::int64_t>;

/// The faces of the mesh found by sorting all sides of all cells.
std::vector<Shared> faces_by_sorting(const testing::ExplicitMesh& mesh) {
  std::vector<std::pair<std::array<std::int64_t, 3>, std::int64_t>> sides;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::int64_t, 3> face{};
      for (std::size_t i = 0, j = 0; i < 4; ++i)
        if (i != left_out) face[j++] = mesh.cells[c][i];
      std::sort(face.begin(), face.end());
      sides.emplace_back(face, static_cast<std::int64_t>(c));
    }
  std::sort(sides.begin(), sides.end());
  std::vector<Shared> faces;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool shared = i + 1 < sides.size() && sides[i].first == sides[i + 1].first;
    faces.emplace_back(sides[i].first, sides[i].second, shared ? sides[i + 1].second : -1);
    if (shared) ++i;
  }
  return faces;
}

Point3 centre_of(const FoamMesh& mesh, const std::array<std::int32_t, 3>& face) {
  Point3 centre{};
  for (const std::int32_t p : face)
    for (std::size_t c = 0; c < 3; ++c)
      centre[c] += mesh.points[static_cast<std::size_t>(p)][c] / 3;
  return centre;
}

/// Area normal of the face, dotted with the way from `from` to its centre.
double outwardness(const FoamMesh& mesh, const std::array<std::int32_t, 3>& face,
                   const Point3& from) {
  const Point3& a = mesh.points[static_cast<std::size_t>(face[0])];
  const Point3& b = mesh.points[static_cast<std::size_t>(face[1])];
  const Point3& c = mesh.points[static_cast<std::size_t>(face[2])];
  Point3 u{}, v{}, w{};
  const Point3 centre = centre_of(mesh, face);
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = centre[i] - from[i];
  }
  return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
         (u[0] * v[1] - u[1] * v[0]) * w[2];
}

class OpenFoam : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
  const testing::FormatsCity& city = testing::formats_city();

  FoamMesh write_and_read() {
    write_openfoam(folder / "constant/polyMesh", city.city.mesh, city.boundary, city.placement);
    return read_foam(folder / "constant/polyMesh");
  }
};

TEST_F(OpenFoam, PointsAreThoseOfTheVolume) {
  const FoamMesh mesh = write_and_read();
  EXPECT_EQ(mesh.points, testing::explicit_mesh(city.city.mesh, city.placement.shift).points);
  EXPECT_NE(mesh.points_header.find("arch        \"LSB;label=32;scalar=64\";"), std::string::npos);
  EXPECT_NE(mesh.points_header.find("note        \"origin 319000 6396000 0 town "),
            std::string::npos);
}

TEST_F(OpenFoam, TownIsWiderByTheHeightOfWhatStands) {
  const SurfaceMesh& boundary = city.boundary;
  std::vector<Building> buildings;
  std::vector<double> tops;
  std::array<double, 4> box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  double low = kInfinity;
  for (std::size_t i = 0; i < boundary.triangles.size(); ++i) {
    if (boundary.patch[i] != Patch::kRoof && boundary.patch[i] != Patch::kWall) continue;
    const auto b = static_cast<std::size_t>(boundary.building[i].value());
    buildings.resize(std::max(buildings.size(), b + 1));
    tops.resize(buildings.size(), -kInfinity);
    for (const std::int32_t v : boundary.triangles[i]) {
      const auto& p = boundary.points[static_cast<std::size_t>(v)];
      box = {std::min(box[0], p[0]), std::min(box[1], p[1]), std::max(box[2], p[0]),
             std::max(box[3], p[1])};
      low = std::min(low, p[2]);
      tops[b] = std::max(tops[b], p[2]);
    }
  }
  const auto tallest = std::max_element(tops.begin(), tops.end());
  const auto town = [&](double height) {
    const auto& shift = city.placement.shift;
    return std::array{box[0] - height + shift[0], box[1] - height + shift[1],
                      box[2] + height + shift[0], box[3] + height + shift[1]};
  };
  std::vector<Building> given;
  const auto written = [&] {
    write_openfoam(folder / "mesh", city.city.mesh, boundary, city.placement, {}, {}, given);
    const std::string header = read_foam(folder / "mesh").points_header;
    std::istringstream words(header.substr(header.find(" town ") + 6));
    std::array<double, 4> numbers{};
    for (double& number : numbers) words >> number;
    return numbers;
  };
  const auto expect = [&](double height) {
    const std::array<double, 4> found = written(), expected = town(height);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << i;
  };
  expect(*tallest - low);  // without the city
  for (std::size_t b = 0; b < buildings.size(); ++b)
    buildings[b].h_roof = tops[b], buildings[b].source_ids = {std::to_string(b)};
  given = buildings;
  expect(*tallest - low);
  Building& tower = given[static_cast<std::size_t>(tallest - tops.begin())];
  tower.source_ids = {"planned:1"};
  *tallest = -kInfinity;
  const double next = *std::max_element(tops.begin(), tops.end());
  expect(next - low);
  // Merged with what stands, which is half a metre higher than all others.
  tower.source_ids = {"1", "planned:1"};
  for (const char* id : {"1", "planned:1"}) {
    RoofPart& part = tower.parts.emplace_back();
    part.outline = {{{0, 0}, {9, 0}, {9, 9}}, {}};
    part.source_id = id;
    part.roof.elevation = next + (tower.parts.size() == 1 ? 0.5 : 30);
  }
  expect(next + 0.5 - low);
}

TEST_F(OpenFoam, FacesAreThoseFoundBySorting) {
  const FoamMesh mesh = write_and_read();
  const auto reference = testing::explicit_mesh(city.city.mesh, city.placement.shift);
  ASSERT_EQ(mesh.faces.size(), 2 * reference.cells.size() + city.boundary.triangles.size() / 2);
  ASSERT_EQ(mesh.owner.size(), mesh.faces.size());
  ASSERT_EQ(mesh.neighbour.size(), mesh.faces.size() - city.boundary.triangles.size());
  std::vector<Shared> found;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    std::array<std::int64_t, 3> face{mesh.faces[f][0], mesh.faces[f][1], mesh.faces[f][2]};
    std::sort(face.begin(), face.end());
    found.emplace_back(face, mesh.owner[f], f < mesh.neighbour.size() ? mesh.neighbour[f] : -1);
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, faces_by_sorting(reference));
  EXPECT_NE(mesh.owner_header.find("nPoints:" + std::to_string(mesh.points.size()) +
                                   "  nCells:" + std::to_string(reference.cells.size()) +
                                   "  nFaces:" + std::to_string(mesh.faces.size()) +
                                   "  nInternalFaces:" + std::to_string(mesh.neighbour.size())),
            std::string::npos)
      << mesh.owner_header;
}

TEST_F(OpenFoam, InternalFacesAreInUpperTriangularOrder) {
  const FoamMesh mesh = write_and_read();
  for (std::size_t f = 0; f < mesh.neighbour.size(); ++f) {
    ASSERT_LT(mesh.owner[f], mesh.neighbour[f]) << f;
    if (f == 0) continue;
    ASSERT_LT(std::pair(mesh.owner[f - 1], mesh.neighbour[f - 1]),
              std::pair(mesh.owner[f], mesh.neighbour[f]))
        << f;
  }
}

TEST_F(OpenFoam, NormalsLeaveTheOwner) {
  const FoamMesh mesh = write_and_read();
  const auto reference = testing::explicit_mesh(city.city.mesh, city.placement.shift);
  const auto centre = [&](std::int32_t cell) {
    Point3 sum{};
    for (const std::int64_t p : reference.cells[static_cast<std::size_t>(cell)])
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += reference.points[static_cast<std::size_t>(p)][c] / 4;
    return sum;
  };
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    ASSERT_GT(outwardness(mesh, mesh.faces[f], centre(mesh.owner[f])), 0) << f;
    if (f >= mesh.neighbour.size()) continue;
    ASSERT_LT(outwardness(mesh, mesh.faces[f], centre(mesh.neighbour[f])), 0) << f;
  }
}

TEST_F(OpenFoam, PatchesFollowTheInternalFacesAndHoldTheBoundary) {
  const FoamMesh mesh = write_and_read();
  const auto counts = count_by_patch(city.boundary);
  ASSERT_EQ(mesh.patches.size(), 8U);
  std::size_t start = mesh.neighbour.size();
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(mesh.patches[i].name, counts[i].name);
    EXPECT_EQ(mesh.patches[i].type, i < 3 ? "wall" : "patch");
    EXPECT_EQ(mesh.patches[i].start, start);
    EXPECT_EQ(mesh.patches[i].faces, static_cast<std::size_t>(counts[i].faces));
    EXPECT_GT(counts[i].faces, 0);
    start += mesh.patches[i].faces;
  }
  EXPECT_EQ(start, mesh.faces.size());
  const auto corners = testing::corners_of(city.boundary, city.placement.shift);
  for (std::size_t f = 0; f < corners.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i)
      ASSERT_EQ(mesh.points[static_cast<std::size_t>(mesh.faces[mesh.neighbour.size() + f][i])],
                corners[f][i])
          << f;
}

TEST_F(OpenFoam, TerrainWithoutBuildingsHasEmptyPatches) {
  const auto& terrain = testing::formats_terrain();
  write_openfoam(folder / "mesh", terrain.city.mesh, terrain.boundary, {});
  const FoamMesh mesh = read_foam(folder / "mesh");
  ASSERT_EQ(mesh.patches.size(), 8U);
  EXPECT_EQ(mesh.patches[1].faces, 0U);
  EXPECT_EQ(mesh.patches[2].faces, 0U);
  EXPECT_EQ(mesh.patches[2].start, mesh.patches[3].start);
}

TEST_F(OpenFoam, ForeignBoundaryIsRefused) {
  SurfaceMesh moved = city.boundary;
  moved.points[17][2] += 1e-3;
  const std::string message = testing::error_of(
      [&] { write_openfoam(folder / "mesh", city.city.mesh, moved, {}); }, ErrorKind::kGuarantee);
  EXPECT_EQ(message, "the surface is not the boundary of the volume mesh");
  EXPECT_FALSE(std::filesystem::exists(folder / "mesh/points"));
}

}  // namespace
}  // namespace tetropolis
