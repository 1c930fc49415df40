#include "tetropolis/volume/column_mesh.h"

#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

std::array<double, 3> at(const ColumnMesh& mesh, const Node& node) {
  const Point2 p = mesh.ground.vertices[static_cast<std::size_t>(node.vertex)];
  return {p.x, p.y, mesh.column(static_cast<std::size_t>(node.vertex))[node.layer]};
}

double volume(const ColumnMesh& mesh, const std::array<Node, 4>& tet) {
  std::array<std::array<double, 3>, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = at(mesh, tet[i]);
  double m[3][3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      m[r][c] = p[static_cast<std::size_t>(r) + 1][static_cast<std::size_t>(c)] -
                p[0][static_cast<std::size_t>(c)];
  return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
          m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
          m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
         6;
}

/// Columns whose layers are spaced at random but rise.
ColumnMesh random_columns(unsigned seed) {
  const auto city = testing::small_city(testing::hills);
  ColumnMesh mesh = make_columns(mesh_ground(city.footprints, city.domain, {12, 25}), 5, 0, 50);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.01, 20);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    double z = step(random);
    for (std::size_t k = 0; k < mesh.stride(); ++k) mesh.column(v)[k] = z += step(random);
  }
  return mesh;
}

double triangle_area(const ColumnMesh& mesh, std::size_t t) {
  const auto& v = mesh.ground.triangles[t];
  const Point2 a = mesh.ground.vertices[static_cast<std::size_t>(v[0])],
               b = mesh.ground.vertices[static_cast<std::size_t>(v[1])],
               c = mesh.ground.vertices[static_cast<std::size_t>(v[2])];
  return ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;
}

TEST(ColumnMesh, VolumeOfATetIsAThirdOfBaseTimesVerticalEdge) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  const ColumnMesh mesh = random_columns(seed);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const double area = triangle_area(mesh, t);
    for (std::int32_t k = 0; k < mesh.layers; ++k)
      for (const auto& tet : prism_tets(mesh, static_cast<TriangleIndex>(t), k)) {
        double edge = 0;
        int vertical_edges = 0;
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = i + 1; j < 4; ++j)
            if (tet[i].vertex == tet[j].vertex) {
              ++vertical_edges;
              edge = std::abs(at(mesh, tet[i])[2] - at(mesh, tet[j])[2]);
            }
        ASSERT_EQ(vertical_edges, 1);
        ASSERT_NEAR(volume(mesh, tet), area * edge / 3, 1e-9 * area * edge);
      }
  }
}

TEST(ColumnMesh, CellsShareWholeFacesAndFillTheirPrisms) {
  const unsigned seed = testing::test_seed() + 1;
  SCOPED_TRACE(seed);
  const ColumnMesh mesh = random_columns(seed);
  using Key = std::array<std::pair<VertexIndex, std::int32_t>, 3>;
  std::map<Key, int> faces;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::int32_t k = 0; k < mesh.layers; ++k)
      for (const auto& tet : prism_tets(mesh, static_cast<TriangleIndex>(t), k))
        for (std::size_t skip = 0; skip < 4; ++skip) {
          Key key;
          std::size_t n = 0;
          for (std::size_t i = 0; i < 4; ++i)
            if (i != skip) key[n++] = {tet[i].vertex, tet[i].layer};
          std::sort(key.begin(), key.end());
          ++faces[key];
        }
  std::size_t single = 0;
  for (const auto& [key, count] : faces) {
    ASSERT_LE(count, 2);
    single += count == 1;
  }
  std::size_t rim = 0;
  for (const auto& triangles : mesh.edges.triangles) rim += triangles[1] == kNoTriangle;
  EXPECT_EQ(single, 2 * mesh.triangle_count() + 2 * rim * static_cast<std::size_t>(mesh.layers));
}

TEST(ColumnMesh, NumbersOnlyNodesWithCells) {
  const auto city = testing::meshed(testing::small_city(testing::hills));
  const ColumnMesh& mesh = city.mesh;
  const auto offsets = node_offsets(mesh);
  std::vector<int> used(static_cast<std::size_t>(offsets.back()), 0);
  NodeIndex cells = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::int32_t k = mesh.first_layer[t]; k < mesh.layers; ++k)
      for (const auto& tet : prism_tets(mesh, static_cast<TriangleIndex>(t), k)) {
        ++cells;
        for (const Node& node : tet) {
          const auto v = static_cast<std::size_t>(node.vertex);
          ASSERT_GE(node.layer, mesh.first_node[v]);
          used[static_cast<std::size_t>(offsets[v] + node.layer - mesh.first_node[v])] = 1;
        }
      }
  EXPECT_EQ(cells, cell_count(mesh));
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
}

TEST(ColumnMesh, RefusesADomainWithoutHeight) {
  const GroundMesh ground = mesh_ground({}, {0, 0, 10, 10}, {5, 25});
  EXPECT_THROW(make_columns(ground, 0, 0, 10), Error);
  EXPECT_THROW(make_columns(ground, 3, 10, 10), Error);
}

}  // namespace
}  // namespace tetropolis
