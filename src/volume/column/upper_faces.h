// The faces of a mesh's upper part.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

inline Point3 upper_position(const ColumnMesh& mesh, UpperPlace p) {
  const std::size_t columns = mesh.vertex_count();
  if (p < columns) return position(mesh, VertexIndex(p.value()), upper_node(mesh, p));
  const Point2 below = mesh.ground.vertices[mesh.upper.vertex[p - columns]];
  return {below.x, below.y, mesh.upper.z[p - columns]};
}

/// Corners of the uppermost cell of triangle t's stack: the last column to reach its end has it.
std::array<Point3, 4> uppermost_cell(const ColumnMesh& mesh, TriangleIndex t);

/// A face between two cells of the upper part, which count from 0 there: its normal leaves the
/// first for the second, whose number is higher.
struct InnerFace {
  std::array<std::size_t, 2> cells;
  std::array<UpperMesh::Cell, 2> corners;
  std::array<UpperPlace, 3> places;
};

/// Calls visit(chunk, face) for the faces between two cells, each once, several at the same time;
/// what is in which chunk does not depend on threads. Takes 2 bytes per cell.
void visit_inner_faces(const ColumnMesh& mesh,
                       const std::function<void(std::size_t, const InnerFace&)>& visit);
/// Chunks are below this.
std::size_t inner_face_chunks(const ColumnMesh& mesh);

/// Of all nodes the highest elevation.
double top_of(const ColumnMesh& mesh);

/// Calls visit(cell, corners, places, is_top) for those on the domain's boundary, by cell, which
/// count from 0 in the upper part.
void visit_outer_faces(const ColumnMesh& mesh,
                       const std::function<void(std::size_t, const UpperMesh::Cell&,
                                                const std::array<UpperPlace, 3>&, bool)>& visit);

/// A face between two cells, which count from 0 in the upper part: its normal (right-hand rule)
/// leaves `cell` for `neighbour`, and cell < neighbour.
struct UpperFace {
  std::uint32_t cell, neighbour;
  std::array<UpperPlace, 3> places;
};

/// By cell, then by neighbour. Time and memory linear in the upper part: 80 bytes per cell.
std::vector<UpperFace> upper_faces(const ColumnMesh& mesh);

/// The nodes of the mesh at some places.
inline std::array<NodeIndex, 3> upper_nodes(const ColumnMesh& mesh,
                                            const std::array<UpperPlace, 3>& p) {
  return {upper_node(mesh, p[0]), upper_node(mesh, p[1]), upper_node(mesh, p[2])};
}

}  // namespace tetropolis
