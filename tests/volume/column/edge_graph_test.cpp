#include "tetropolis/volume/column/edge_graph.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/indices.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

TEST(EdgeGraph, HoldsEveryEdgeOnceWithItsTriangles) {
  const auto city = testing::small_city(testing::hills);
  const GroundMesh mesh = mesh_ground(city.footprints, city.domain, {9, 25});
  const EdgeGraph graph = build_edge_graph(mesh);

  std::map<std::pair<VertexIndex, VertexIndex>, std::set<TriangleIndex>> expected;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
      expected[{std::min(a, b), std::max(a, b)}].insert(TriangleIndex(t));
    }
  ASSERT_EQ(graph.size(), expected.size());
  std::size_t e = 0;
  for (const auto& [edge, triangles] : expected) {  // the map is in the graph's order
    ASSERT_EQ(graph.vertices[e][0], edge.first);
    ASSERT_EQ(graph.vertices[e][1], edge.second);
    std::set<TriangleIndex> found{graph.triangles[e][0]};
    if (graph.triangles[e][1] != kNoTriangle) found.insert(graph.triangles[e][1]);
    EXPECT_EQ(found, triangles);
    ++e;
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto v = sorted_vertices(mesh.triangles[t]);
    const auto& edges = graph.of_triangle[t];
    EXPECT_EQ(graph.vertices[static_cast<std::size_t>(edges[0])], (std::array{v[0], v[1]}));
    EXPECT_EQ(graph.vertices[static_cast<std::size_t>(edges[1])], (std::array{v[0], v[2]}));
    EXPECT_EQ(graph.vertices[static_cast<std::size_t>(edges[2])], (std::array{v[1], v[2]}));
  }
  std::size_t filed = 0;
  for (const VertexIndex v : mesh.vertices.indices()) {
    for (const EdgeIndex i : graph.starting_at(v)) EXPECT_EQ(graph.vertices[i][0], v);
    for (const EdgeIndex i : graph.ends[v]) EXPECT_EQ(graph.vertices[i][1], v);
    filed += static_cast<std::size_t>(graph.starts[v + 1] - graph.starts[v]) + graph.ends[v].size();
  }
  EXPECT_EQ(filed, 2 * graph.size());
}

TEST(EdgeGraph, RefusesThreeTrianglesAtAnEdge) {
  GroundMesh mesh;
  mesh.vertices = {{0, 0}, {1, 0}, {0, 1}, {0, -1}, {1, 1}};
  mesh.triangles = testing::triangles_of({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  EXPECT_THROW(build_edge_graph(mesh), Error);
}

}  // namespace
}  // namespace tetropolis
