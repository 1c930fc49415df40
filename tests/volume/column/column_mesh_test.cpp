#include "tetropolis/volume/column/column_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "support/test_data.h"
#include "support/tet_shape.h"

namespace tetropolis {
namespace {

/// Columns without buildings, of random numbers of randomly spaced nodes.
ColumnMesh random_columns(unsigned seed, bool equal_spacing = false) {
  const auto city = testing::small_city(testing::hills);
  ColumnMesh mesh;
  mesh.ground = mesh_ground({}, city.domain, {20, 25});
  mesh.edges = build_edge_graph(mesh.ground);
  mesh.regions = regions_at_vertices(mesh.ground);
  mesh.floors.assign(mesh.regions.values.size(), 0);
  mesh.first = {NodeIndex(0)};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.01, 20);
  std::uniform_int_distribution<int> count(2, 12);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    double z = equal_spacing ? 0 : step(random);
    const int nodes = equal_spacing ? 6 : count(random);
    for (int i = 0; i < nodes; ++i) mesh.z.push_back(z += equal_spacing ? 10 : step(random));
    mesh.first.push_back(NodeIndex(mesh.z.size()));
  }
  return mesh;
}

double triangle_area(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& v = mesh.ground.triangles[t];
  const Point2 a = mesh.ground.vertices[static_cast<std::size_t>(v[0])],
               b = mesh.ground.vertices[static_cast<std::size_t>(v[1])],
               c = mesh.ground.vertices[static_cast<std::size_t>(v[2])];
  return ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;
}

/// How many cells each face has.
std::map<std::array<NodeIndex, 3>, int> count_faces(const ColumnMesh& mesh) {
  std::map<std::array<NodeIndex, 3>, int> faces;
  for (const TriangleIndex t : mesh.ground.triangles.indices())
    for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& tet) {
      for (std::size_t skip = 0; skip < 4; ++skip) {
        std::array<NodeIndex, 3> face{};
        for (std::size_t i = 0, n = 0; i < 4; ++i)
          if (i != skip) face[n++] = tet[i];
        std::sort(face.begin(), face.end());
        ++faces[face];
      }
    });
  return faces;
}

TEST(ColumnMesh, VolumeOfATetIsAThirdOfBaseTimesVerticalEdge) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  const ColumnMesh mesh = random_columns(seed);
  const auto points = testing::explicit_mesh(mesh).points;
  const auto at = [&](NodeIndex n) { return points[static_cast<std::size_t>(n)]; };
  for (const TriangleIndex t : mesh.ground.triangles.indices())
    for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& tet) {
      const double edge = at(tet[3])[2] - at(tet[3] - 1)[2];
      ASSERT_EQ(std::count(tet.begin(), tet.end(), tet[3] - 1), 1);
      const testing::TetShape shape =
          testing::tet_shape(at(tet[0]), at(tet[1]), at(tet[2]), at(tet[3]));
      const double expected = triangle_area(mesh, t) * edge / 3;
      ASSERT_NEAR(shape.volume, expected, 1e-9 * expected);
    });
}

TEST(ColumnMesh, RandomColumnsConformAndFillTheirSpace) {
  for (unsigned i = 0; i < 20; ++i) {
    const unsigned seed = testing::test_seed() + i;
    SCOPED_TRACE(seed);
    const ColumnMesh mesh = random_columns(seed);
    std::size_t single = 0;
    for (const auto& [face, count] : count_faces(mesh)) {
      ASSERT_LE(count, 2);
      single += count == 1;
    }
    // The boundary: floor and top of every triangle, and the strips over the rim.
    std::size_t expected = 2 * mesh.triangle_count();
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
      if (mesh.edges.triangles[e][1] == kNoTriangle)
        for (const VertexIndex v : mesh.edges.vertices[e])
          expected += static_cast<std::size_t>(mesh.top(v) - mesh.first[v]);
    EXPECT_EQ(single, expected);
    EXPECT_GT(require_valid(mesh), 0);
  }
}

TEST(ColumnMesh, ClimbsAsTheSortedSegmentsSay) {
  const auto city = testing::meshed(testing::small_city(testing::hills));
  for (const ColumnMesh& mesh : {random_columns(testing::test_seed()), city.mesh}) {
    const auto reference = testing::explicit_mesh(mesh);
    std::vector<std::array<std::int64_t, 4>> cells;
    const std::vector<CellIndex> offsets = cell_offsets(mesh);
    for (const TriangleIndex t : mesh.ground.triangles.indices()) {
      ASSERT_EQ(offsets[t], cells.size());
      for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& tet) {
        cells.push_back({tet[0].value(), tet[1].value(), tet[2].value(), tet[3].value()});
      });
    }
    EXPECT_EQ(offsets.back(), cells.size());
    EXPECT_EQ(cells, reference.cells);
    std::vector<int> used(mesh.z.size(), 0);
    for (const auto& cell : cells)
      for (const std::int64_t n : cell) used[static_cast<std::size_t>(n)] = 1;
    EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
  }
}

TEST(ColumnMesh, EqualLayersAreThePapersPrisms) {
  const ColumnMesh mesh = random_columns(1, true);
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const auto v = sorted_vertices(mesh.ground.triangles[t]);
    std::vector<std::array<NodeIndex, 4>> cells;
    for_each_tet_over(mesh, t, [&](std::array<NodeIndex, 4> tet) {
      std::sort(tet.begin(), tet.end());
      cells.push_back(tet);
    });
    ASSERT_EQ(cells.size(), 15U);
    for (std::size_t k = 0; k < 5; ++k) {
      const auto u = [&](std::size_t i) { return mesh.first[v[i]] + k; };
      const auto w = [&](std::size_t i) { return u(i) + 1; };
      const std::array<std::array<NodeIndex, 4>, 3> paper{
          {{u(0), u(1), u(2), w(2)}, {u(0), u(1), w(1), w(2)}, {u(0), w(0), w(1), w(2)}}};
      for (std::size_t i = 0; i < 3; ++i) {
        auto expected = paper[i];
        std::sort(expected.begin(), expected.end());
        ASSERT_EQ(cells[k * 3 + i], expected);
      }
    }
  }
}

TEST(ColumnMesh, RefusesColumnsThatDoNotIncreaseAndRoofsThatAreNotFlat) {
  const auto city = testing::meshed(testing::small_city(testing::hills));
  EXPECT_NO_THROW(require_valid(city.mesh));
  ColumnMesh folded = city.mesh;
  folded.z[5] = folded.z[4];
  EXPECT_THROW(require_valid(folded), Error);
  ColumnMesh tilted = city.mesh;
  for (std::size_t v = 0; v < tilted.vertex_count(); ++v)
    if (city.plan.lowest_roof[v] != kNoRegion) {
      tilted.z[static_cast<std::size_t>(tilted.floor(city.plan.lowest_roof[v], VertexIndex(v)))] +=
          1e-3;
      break;
    }
  EXPECT_THROW(require_valid(tilted), Error);
}

TEST(ColumnMesh, HeightsThatAreNoNumbersAreNoValidMesh) {
  const ColumnMesh mesh = random_columns(3);
  require_valid(mesh);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()})
    for (const std::size_t node : {std::size_t{0}, mesh.z.size() / 2, mesh.z.size() - 1}) {
      ColumnMesh broken = mesh;
      broken.z[node] = bad;
      EXPECT_THROW(require_valid(broken), Error) << bad << " at node " << node;
    }
}

}  // namespace
}  // namespace tetropolis
