#include "tetropolis/volume/column/edge_graph.h"

#include <algorithm>
#include <string>
#include <utility>

#include "tetropolis/core/error.h"

#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/sort_once.h"

namespace tetropolis {

namespace {

/// One side of a triangle, filed under its lower vertex.
struct TriangleSide {
  VertexIndex upper;
  TriangleIndex triangle;
  std::uint32_t slot;  // position in of_triangle
};

constexpr std::array<std::array<std::uint32_t, 2>, 3> kSides = {{{0, 1}, {0, 2}, {1, 2}}};

/// Whether sides before this one, of those of a vertex in order, are of other edges.
bool begins_edge(std::span<const TriangleSide> sides, std::size_t i) {
  return i == 0 || sides[i - 1].upper != sides[i].upper;
}

/// Per vertex: the sides that it is the lower vertex of.
RaggedArray<TriangleSide, std::int32_t> sides_by_lower_vertex(const GroundMesh& mesh) {
  return ragged_from_pairs<TriangleSide, std::int32_t>(mesh.vertices.size(), [&](const auto& use) {
    for (const TriangleIndex t : mesh.triangles.indices()) {
      const auto v = sorted_vertices(mesh.triangles[t]);
      for (std::uint32_t slot = 0; slot < 3; ++slot)
        use(v[kSides[slot][0]], TriangleSide{v[kSides[slot][1]], t, slot});
    }
  });
}

}  // namespace

std::array<VertexIndex, 3> sorted_vertices(const std::array<VertexIndex, 3>& triangle) {
  auto v = triangle;
  if (v[0] > v[1]) std::swap(v[0], v[1]);
  if (v[1] > v[2]) std::swap(v[1], v[2]);
  if (v[0] > v[1]) std::swap(v[0], v[1]);
  return v;
}

EdgeGraph build_edge_graph(const GroundMesh& mesh) {
  constexpr std::size_t kGrain = 16384;
  const std::size_t vertices = mesh.vertices.size();
  RaggedArray<TriangleSide, std::int32_t> sides = sides_by_lower_vertex(mesh);
  EdgeGraph graph;
  graph.starts.assign(vertices + 1, EdgeIndex(0));  // from 1 on: edges of each, at first
  parallel_chunks(vertices, kGrain, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      const std::span<TriangleSide> own = sides[v];
      std::sort(own.begin(), own.end(), [](const TriangleSide& a, const TriangleSide& b) {
        return a.upper != b.upper ? a.upper < b.upper : a.triangle < b.triangle;
      });
      for (std::size_t i = 0; i < own.size(); ++i)
        if (begins_edge(own, i)) ++graph.starts[v + 1];
    }
  });
  for (const VertexIndex v : mesh.vertices.indices())
    graph.starts[v + 1] += graph.starts[v].value();
  graph.vertices.resize(graph.starts.back());
  graph.triangles.resize(graph.starts.back());
  graph.of_triangle.resize(mesh.triangles.size());
  parallel_chunks(vertices, kGrain, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      const std::span<const TriangleSide> own = sides[v];
      EdgeIndex e = graph.starts[v];
      for (std::size_t i = 0; i < own.size(); ++i) {
        const TriangleSide& side = own[i];
        if (begins_edge(own, i)) {
          graph.vertices[e] = {v, side.upper};
          graph.triangles[e] = {side.triangle, kNoTriangle};
          ++e;
        } else if (graph.triangles[e - 1][1] == kNoTriangle) {
          graph.triangles[e - 1][1] = side.triangle;
        } else {
          throw Error(ErrorKind::kGuarantee,
                      "ground mesh: more than two triangles at the edge between vertices " +
                          std::to_string(v) + " and " + std::to_string(side.upper));
        }
        graph.of_triangle[side.triangle][side.slot] = e - 1;
      }
    }
  });
  graph.ends = ragged_from_pairs<EdgeIndex, std::int32_t>(vertices, [&](const auto& use) {
    for (const EdgeIndex e : graph.vertices.indices()) use(graph.vertices[e][1], e);
  });
  return graph;
}

std::vector<TriangleIndex> triangles_around(const EdgeGraph& edges,
                                            std::span<const VertexIndex> vertices) {
  std::vector<TriangleIndex> triangles;
  const auto add = [&](EdgeIndex e) {
    for (const TriangleIndex t : edges.triangles[e])
      if (t != kNoTriangle) triangles.push_back(t);
  };
  for (const VertexIndex v : vertices) {
    for (const EdgeIndex e : edges.starting_at(v)) add(e);
    for (const EdgeIndex e : edges.ends[v]) add(e);
  }
  sort_once(triangles);
  return triangles;
}

}  // namespace tetropolis
