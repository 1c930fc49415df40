#include "volume/layers/prism_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/explicit_mesh.h"
#include "tetropolis/volume/quality/prism_quality.h"

#include "support/explicit_mesh.h"
#include "support/prism_city.h"
#include "volume/column/ground_heights.h"
#include "volume/column/layers_at_walls.h"

namespace tetropolis {
namespace {

constexpr LayerHeights kFive{5, 0.5, 1.2};
using testing::prism_city;

using Nodes = std::vector<std::int64_t>;

/// A face with the lowest node first, in its direction.
Nodes turned(Nodes nodes) {
  std::rotate(nodes.begin(), std::min_element(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Nodes reversed(Nodes nodes) {
  std::reverse(nodes.begin(), nodes.end());
  return turned(std::move(nodes));
}

/// Tets and prisms as lists, the plain way.
struct Lists {
  std::vector<std::array<double, 3>> points;
  std::vector<Nodes> cells;

  explicit Lists(const ColumnMesh& mesh) : points(static_cast<std::size_t>(mesh.node_count())) {
    fill_points(mesh, {0, 0, 0}, points);
    if (!mesh.layers.whole)
      for (const auto& tet : testing::explicit_mesh(mesh).cells)
        cells.push_back({tet.begin(), tet.end()});
    std::vector<std::array<NodeIndex, 6>> wedges(static_cast<std::size_t>(mesh.layers.cells()));
    fill_wedges(mesh, wedges);
    for (const auto& w : wedges) {
      Nodes& cell = cells.emplace_back();
      for (const NodeIndex n : w) cell.push_back(n.value());
    }
  }
  /// The faces of a cell, normals outwards.
  static std::vector<Nodes> faces(const Nodes& n) {
    if (n.size() == 4)
      return {{n[0], n[2], n[1]}, {n[0], n[1], n[3]}, {n[1], n[2], n[3]}, {n[0], n[3], n[2]}};
    return {{n[0], n[2], n[1]},
            {n[3], n[4], n[5]},
            {n[0], n[1], n[4], n[3]},
            {n[1], n[2], n[5], n[4]},
            {n[2], n[0], n[3], n[5]}};
  }
  /// Of a closed surface: a face's share of the volume, from the triangles around its first node.
  double share(const Nodes& face) const {
    double sum = 0;
    const auto p = [&](std::size_t i) { return points[static_cast<std::size_t>(face[i])]; };
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Point3 a = p(0), b = p(i), c = p(i + 1);
      sum += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
              a[2] * (b[0] * c[1] - b[1] * c[0])) /
             6;
    }
    return sum;
  }
};

/// Cells are positive and share whole faces, the boundary and the faces between cells are those
/// that a map of all finds, and the volume is that above the floors of `plan`.
void expect_conforming(const ColumnMesh& mesh, const ColumnPlan& plan) {
  const Lists lists(mesh);
  std::map<Nodes, std::int64_t> faces;  // per face, in the direction that leaves it, the cell
  double volume = 0;
  for (std::size_t c = 0; c < lists.cells.size(); ++c) {
    double own = 0;
    for (const Nodes& face : Lists::faces(lists.cells[c])) {
      EXPECT_TRUE(faces.emplace(turned(face), static_cast<std::int64_t>(c)).second);
      own += lists.share(face);
    }
    EXPECT_GT(own, 0);
    volume += own;
  }
  std::map<Nodes, std::int64_t> outer;
  std::map<std::pair<std::int64_t, std::int64_t>, Nodes> inner;
  for (const auto& [nodes, cell] : faces) {
    const auto opposite = faces.find(reversed(nodes));
    if (opposite == faces.end())
      outer.emplace(nodes, cell);
    else if (cell < opposite->second)
      inner.emplace(std::pair(cell, opposite->second), nodes);
  }

  const SurfaceMesh boundary = extract_boundary(mesh);
  EXPECT_TRUE(check_topology(boundary).closed());
  EXPECT_TRUE(check_topology(boundary).manifold());
  const SurfaceFaces surface(boundary);
  ASSERT_EQ(surface.size(), outer.size());
  std::int64_t quads = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    Nodes nodes;
    for (const std::int32_t p : surface.corners(i))
      nodes.push_back(boundary.node[static_cast<std::size_t>(p)].value());
    quads += surface.is_quad(i) ? 1 : 0;
    ASSERT_EQ(nodes.size(), surface.is_quad(i) ? 4U : 3U);
    const auto found = outer.find(turned(nodes));
    ASSERT_NE(found, outer.end());
    const std::size_t f = surface.triangle(i);
    EXPECT_EQ(boundary.cell[f], CellIndex(found->second));
    if (!surface.is_quad(i)) continue;
    EXPECT_EQ(boundary.cell[f + 1], boundary.cell[f]);
    // At a wall it belongs to the building behind.
    EXPECT_EQ(boundary.patch[f] == Patch::kWall, boundary.building[f] >= 0);
  }
  EXPECT_EQ(quads, std::ssize(boundary.quads));
  EXPECT_GT(quads, 0);
  std::int64_t counted = 0;
  for (const PatchCount& count : count_by_patch(boundary)) counted += count.faces;
  EXPECT_EQ(counted, static_cast<std::int64_t>(surface.size()));

  // As OpenFOAM wants them.
  auto expected = inner.begin();
  for (const CellFace& face : internal_faces(mesh)) {
    ASSERT_NE(expected, inner.end());
    EXPECT_EQ(expected->first, std::pair(face.owner.value(), face.neighbour.value()));
    Nodes nodes;
    for (std::size_t i = 0; i < face.corners; ++i) nodes.push_back(face.nodes[i].value());
    EXPECT_EQ(expected->second, turned(nodes));
    ++expected;
  }
  EXPECT_EQ(expected, inner.end());

  double expected_volume = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const auto& v = mesh.ground.triangles[t];
    const auto at = [&](std::size_t i) { return mesh.ground.vertices[v[i]]; };
    const double area =
        ((at(1).x - at(0).x) * (at(2).y - at(0).y) - (at(1).y - at(0).y) * (at(2).x - at(0).x)) / 2;
    for (const VertexIndex u : v) {
      const double below_tets = mesh.has_layers(t) ? plan.lift[u] : 0;
      const double floor = mesh.z[mesh.floor_over(t, u)] - below_tets;
      expected_volume += area / 3 * (plan.layers.top - floor);
    }
  }
  EXPECT_NEAR(volume / expected_volume, 1, 1e-12);
}

TEST(PrismLayers, ConformAndFillWhatIsBelowTheTets) {
  for (const auto& [name, terrain] : testing::kHardTerrains)
    for (const double size : {12.0, 5.0}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(size));
      const testing::MeshedCity city = prism_city(testing::small_city(terrain), size, kFive);
      expect_conforming(city.mesh, city.plan);
    }
}

TEST(PrismLayers, PrismsAloneConformToo) {
  for (const auto& [name, terrain] : testing::kHardTerrains)
    for (const int layers : {0, 5}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(layers));
      const testing::MeshedCity city =
          testing::city_of_prisms(testing::small_city(terrain), 10, {layers, 0.5, 1.2});
      EXPECT_TRUE(city.mesh.layers.whole);
      EXPECT_EQ(cell_offsets(city.mesh).back(), CellIndex(0));
      expect_conforming(city.mesh, city.plan);
    }
}

TEST(PrismLayers, ColumnsOfDifferentHeightMakeNoPrisms) {
  testing::MeshedCity graded = testing::meshed(testing::small_city(testing::hills), 12);
  EXPECT_THROW(make_whole(graded.mesh), Error);
}

/// Elevations over a vertex of the layers, their top included.
std::vector<double> column_of(const ColumnMesh& mesh, std::size_t i) {
  const auto count = static_cast<std::ptrdiff_t>(mesh.layers.count);
  const auto first = mesh.layers.z.begin() + static_cast<std::ptrdiff_t>(i) * count;
  std::vector<double> z(first, first + count);
  z.push_back(mesh.z[mesh.first[mesh.layers.vertices[i]]]);
  return z;
}

TEST(PrismLayers, AreAsHighAsAskedAwayFromLowWalls) {
  const testing::MeshedCity city = prism_city(testing::small_city(testing::hills), 6, kFive);
  const ColumnMesh& mesh = city.mesh;
  const std::vector<double> terrain = terrain_under(mesh.ground, city.city.dtm);
  std::int64_t whole = 0, thin = 0;
  for (std::size_t i = 0; i < mesh.layers.vertices.size(); ++i) {
    const VertexIndex v = mesh.layers.vertices[i];
    const std::vector<double> z = column_of(mesh, i);
    if (city.plan.ground[v] == terrain[v] + city.plan.lift[v]) {
      EXPECT_NEAR(z[0], terrain[v], 1e-9);
    }
    const double all = z.back() - z[0];
    EXPECT_NEAR(all, city.plan.lift[v], 1e-9);
    EXPECT_LE(all, kFive.total() + 1e-9);
    for (std::size_t k = 2; k < z.size(); ++k) {
      const double ratio = (z[k] - z[k - 1]) / (z[k - 1] - z[k - 2]);
      EXPECT_LE(ratio, 1.2 + 1e-6);
      EXPECT_GE(ratio, 1 / 1.2 - 1e-6);
    }
    // 0.5 m and less from one to the next.
    if (all >=
        0.5 * (1 + 1 / 1.2 + 1 / std::pow(1.2, 2) + 1 / std::pow(1.2, 3) + 1 / std::pow(1.2, 4)) +
            1e-9) {
      EXPECT_NEAR(z[1] - z[0], 0.5, 1e-9);
    } else {
      for (std::size_t k = 1; k < z.size(); ++k) EXPECT_NEAR(z[k] - z[k - 1], all / 5, 1e-9);
      ++thin;
    }
    whole += all > kFive.total() - 1e-9 ? 1 : 0;
    if (city.plan.lowest_roof[v] == kNoRegion) continue;
    // The wall goes on above them.
    const double wall = city.plan.lowest_roof_at(v) - z[0];
    EXPECT_GE(wall, 1 - 1e-9);
    EXPECT_LE(all, 0.63 * wall);
  }
  EXPECT_GT(whole, std::ssize(mesh.layers.vertices) / 2);
  EXPECT_GT(thin, 0);  // at buried walls
  // And change slowly.
  for (const auto& [a, b] : mesh.edges.vertices) {
    const Point2 p = mesh.ground.vertices[a], q = mesh.ground.vertices[b];
    EXPECT_LE(std::abs(city.plan.lift[a] - city.plan.lift[b]),
              0.25 * std::hypot(p.x - q.x, p.y - q.y) + 1e-5);
  }
}

TEST(PrismLayers, WallsLeaveTheirShare) {
  const double all = kFive.total();
  EXPECT_NEAR(all, 0.5 * (std::pow(1.2, 5) - 1) / 0.2, 1e-12);
  EXPECT_EQ(layers_beside_wall(all, 100), all);
  EXPECT_NEAR(layers_beside_wall(all, 6), 3.6, 1e-12);  // three fifths
  EXPECT_NEAR(layers_beside_wall(all, 2), 1, 1e-12);    // a metre is left
  EXPECT_NEAR(layers_beside_wall(all, 1), 0.3, 1e-12);  // three tenths
  for (double wall = 1; wall < 20; wall += 0.01)
    EXPECT_GT(wall - layers_beside_wall(all, wall) + 1e-12,
              wall_above_layers(1, layers_beside_wall(all, wall)));
}

TEST(PrismLayers, LeaveTheMeshAloneWithoutAny) {
  const testing::MeshedCity plain = testing::meshed(testing::small_city(testing::hills), 6);
  EXPECT_EQ(plain.mesh.layers.cells(), 0);
  EXPECT_EQ(measure_prisms(plain.mesh, 0.5).cells, 0);
  EXPECT_TRUE(extract_boundary(plain.mesh).quads.empty());
}

TEST(PrismQuality, IsThatOfPrismsOverALevelTriangle) {
  // Regular triangles with edges of 10 m, one layer of 1 m on level ground: all faces are straight.
  GroundMesh ground;
  const double h = 5 * std::sqrt(3.0);
  ground.vertices = {{0, 0}, {10, 0}, {5, h}, {15, h}};
  ground.triangles = {{VertexIndex(0), VertexIndex(1), VertexIndex(2)},
                      {VertexIndex(1), VertexIndex(3), VertexIndex(2)}};
  ground.regions = {Region{}};
  ground.region.assign(2, RegionIndex(0));
  ColumnMesh mesh;
  mesh.regions = regions_at_vertices(ground);
  mesh.floors.assign(4, 0);
  mesh.edges = build_edge_graph(ground);
  mesh.ground = std::move(ground);
  mesh.first.push_back(NodeIndex(0));
  for (int v = 0; v < 4; ++v) {
    mesh.z.insert(mesh.z.end(), {3, 9});
    mesh.first.push_back(NodeIndex(mesh.z.size()));
  }
  lay_prisms(std::vector(4, 3.0), {3, 1, 1}, mesh);
  const PrismQuality quality = measure_prisms(mesh, 1);
  EXPECT_EQ(quality.cells, 6);
  EXPECT_NEAR(quality.volume, 2 * 5 * h * 3, 1e-9);
  EXPECT_NEAR(quality.least_height, 1, 1e-12);
  EXPECT_NEAR(quality.share_as_asked, 1, 1e-12);
  EXPECT_EQ(quality.faces, 3 + 4 + 2);  // upright, level, to the tets
  EXPECT_NEAR(quality.least_flatness, 1, 1e-12);
  // To the tets: a lowest one has its centre a quarter of the way to the corner that goes first.
  const double aside = 10 / std::sqrt(3.0) / 4, up = 6.0 / 4 + 0.5;
  EXPECT_NEAR(quality.max_non_orthogonality_deg, std::atan(aside / up) * 180 / 3.14159265358979,
              1e-6);
  // Sums of the components of all faces: two triangles of 5 h, and sides 10 m wide, 1 m high.
  EXPECT_NEAR(quality.max_aspect_ratio, 2 * 5 * h / std::min(20.0, 2 * h), 1e-9);
}

}  // namespace
}  // namespace tetropolis
