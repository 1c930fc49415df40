// The edges of a ground mesh, numbered for column-wise work.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"

namespace tetropolis {

using EdgeIndex = Index<struct EdgeTag>;

/// Edges are numbered in lexicographic order of (lower vertex, upper vertex), so the edges that
/// start at a lower vertex are consecutive. A row of any vertex-to-vertex operator is the edges
/// that start at the vertex and the edges that end there.
struct EdgeGraph {
  IndexedVector<EdgeIndex, std::array<VertexIndex, 2>> vertices;  ///< Lower, upper vertex.
  /// The edge's triangles in ascending order; kNoTriangle second on the rim.
  IndexedVector<EdgeIndex, std::array<TriangleIndex, 2>> triangles;
  /// Of a triangle with sorted vertices v1 < v2 < v3: edges v1v2, v1v3, v2v3.
  IndexedVector<TriangleIndex, std::array<EdgeIndex, 3>> of_triangle;
  std::vector<EdgeIndex> starts;              ///< V + 1 offsets: edges with lower vertex v.
  RaggedArray<EdgeIndex, std::int32_t> ends;  ///< Per vertex: edges that it is the upper vertex
                                              ///< of, ascending.

  std::size_t size() const { return vertices.size(); }
  /// The edges that v is the lower vertex of.
  IndexRange<EdgeIndex> starting_at(VertexIndex v) const { return {starts[v], starts[v + 1]}; }
};

/// Time and memory linear in the mesh. Throws Error(kGuarantee) naming the edge if one belongs to
/// more than two triangles.
EdgeGraph build_edge_graph(const GroundMesh& mesh);

/// The triangles that have one of the vertices as a corner, ascending.
std::vector<TriangleIndex> triangles_around(const EdgeGraph& edges,
                                            std::span<const VertexIndex> vertices);

/// The triangle's vertices in ascending order.
std::array<VertexIndex, 3> sorted_vertices(const std::array<VertexIndex, 3>& triangle);

}  // namespace tetropolis
