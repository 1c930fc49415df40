#include "tetropolis/volume/column/edge_graph.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "tetropolis/core/error.h"

#include "core/sort_once.h"

namespace tetropolis {

namespace {

/// One side of a triangle, filed under its lower vertex.
struct Side {
  VertexIndex upper;
  TriangleIndex triangle;
  std::int32_t slot;  // position in of_triangle
};

constexpr std::array<std::array<int, 2>, 3> kSides = {{{0, 1}, {0, 2}, {1, 2}}};

/// Sides of all triangles in a compressed row layout: row v holds those whose lower vertex is v.
std::pair<std::vector<std::int32_t>, std::vector<Side>> sides_by_lower_vertex(
    const GroundMesh& mesh) {
  std::vector<std::int32_t> offsets(mesh.vertices.size() + 1, 0);
  for (const auto& triangle : mesh.triangles) {
    const auto v = sorted_vertices(triangle);
    offsets[static_cast<std::size_t>(v[0]) + 1] += 2;
    offsets[static_cast<std::size_t>(v[1]) + 1] += 1;
  }
  for (std::size_t i = 1; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
  std::vector<Side> sides(mesh.triangles.size() * 3);
  std::vector<std::int32_t> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto v = sorted_vertices(mesh.triangles[t]);
    for (int slot = 0; slot < 3; ++slot) {
      const auto lower = static_cast<std::size_t>(v[kSides[slot][0]]);
      sides[static_cast<std::size_t>(next[lower]++)] = {v[kSides[slot][1]],
                                                        static_cast<TriangleIndex>(t), slot};
    }
  }
  return {std::move(offsets), std::move(sides)};
}

void file_ends(EdgeGraph& graph, std::size_t vertex_count) {
  graph.end_offsets.assign(vertex_count + 1, 0);
  for (const auto& edge : graph.vertices)
    ++graph.end_offsets[static_cast<std::size_t>(edge[1]) + 1];
  for (std::size_t i = 1; i <= vertex_count; ++i) graph.end_offsets[i] += graph.end_offsets[i - 1];
  graph.ends.resize(graph.size());
  std::vector<std::int32_t> next(graph.end_offsets.begin(), graph.end_offsets.end() - 1);
  for (std::size_t e = 0; e < graph.size(); ++e) {
    const auto upper = static_cast<std::size_t>(graph.vertices[e][1]);
    graph.ends[static_cast<std::size_t>(next[upper]++)] = static_cast<EdgeIndex>(e);
  }
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
  auto [offsets, sides] = sides_by_lower_vertex(mesh);
  EdgeGraph graph;
  graph.vertices.reserve(mesh.triangles.size() * 3 / 2 + 64);
  graph.triangles.reserve(graph.vertices.capacity());
  graph.of_triangle.resize(mesh.triangles.size());
  graph.starts.assign(mesh.vertices.size() + 1, 0);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto begin = sides.begin() + offsets[v];
    const auto end = sides.begin() + offsets[v + 1];
    std::sort(begin, end, [](const Side& a, const Side& b) {
      return a.upper != b.upper ? a.upper < b.upper : a.triangle < b.triangle;
    });
    for (auto side = begin; side != end; ++side) {
      const bool known = side != begin && std::prev(side)->upper == side->upper;
      if (!known) {
        graph.vertices.push_back({static_cast<VertexIndex>(v), side->upper});
        graph.triangles.push_back({side->triangle, kNoTriangle});
      } else if (graph.triangles.back()[1] == kNoTriangle) {
        graph.triangles.back()[1] = side->triangle;
      } else {
        throw Error(ErrorKind::kGuarantee,
                    "ground mesh: more than two triangles at the edge between vertices " +
                        std::to_string(v) + " and " + std::to_string(side->upper));
      }
      graph.of_triangle[static_cast<std::size_t>(side->triangle)]
                       [static_cast<std::size_t>(side->slot)] =
          static_cast<EdgeIndex>(graph.vertices.size() - 1);
    }
    graph.starts[v + 1] = static_cast<EdgeIndex>(graph.vertices.size());
  }
  file_ends(graph, mesh.vertices.size());
  return graph;
}

std::vector<TriangleIndex> triangles_around(const EdgeGraph& edges,
                                            std::span<const VertexIndex> vertices) {
  std::vector<TriangleIndex> triangles;
  const auto add = [&](EdgeIndex e) {
    for (const TriangleIndex t : edges.triangles[static_cast<std::size_t>(e)])
      if (t != kNoTriangle) triangles.push_back(t);
  };
  for (const VertexIndex vertex : vertices) {
    const auto v = static_cast<std::size_t>(vertex);
    for (EdgeIndex e = edges.starts[v]; e < edges.starts[v + 1]; ++e) add(e);
    for (std::int32_t k = edges.end_offsets[v]; k < edges.end_offsets[v + 1]; ++k)
      add(edges.ends[static_cast<std::size_t>(k)]);
  }
  sort_once(triangles);
  return triangles;
}

}  // namespace tetropolis
