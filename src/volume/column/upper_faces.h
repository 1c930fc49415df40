// The faces of a mesh's upper part.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// The ground vertex that nodes of the upper part and ends of columns are over. Takes a byte for
/// every four nodes of columns.
class UpperNodes {
 public:
  explicit UpperNodes(const ColumnMesh& mesh);
  VertexIndex vertex(NodeIndex n) const {
    if (n >= mesh_.column_nodes())
      return mesh_.upper.vertex[static_cast<std::size_t>(n.value() - mesh_.column_nodes())];
    VertexIndex v = first_of_block_[static_cast<std::size_t>(n.value()) / kBlock];
    while (mesh_.first[v + 1] <= n) ++v;
    return v;
  }
  Point3 operator[](NodeIndex n) const {
    if (n >= mesh_.column_nodes())
      return mesh_.upper.points[static_cast<std::size_t>(n.value() - mesh_.column_nodes())];
    return position(mesh_, vertex(n), n);
  }
  /// Numbers ends of columns, and after them nodes of the upper part: in the same order.
  std::size_t place(NodeIndex n) const {
    if (n < mesh_.column_nodes()) return vertex(n);
    return mesh_.vertex_count() + static_cast<std::size_t>(n.value() - mesh_.column_nodes());
  }
  std::size_t places() const { return mesh_.vertex_count() + mesh_.upper.points.size(); }

 private:
  static constexpr std::size_t kBlock = 16;  // of nodes
  const ColumnMesh& mesh_;
  std::vector<VertexIndex> first_of_block_;
};

/// Corners of the uppermost cell of triangle t's stack: the last column to reach its end has it.
std::array<Point3, 4> uppermost_cell(const ColumnMesh& mesh, TriangleIndex t);

/// A cell's face: its normal (right-hand rule) leaves the cell.
struct UpperFace {
  CellIndex cell;
  std::array<NodeIndex, 3> nodes;
};

/// The faces of the upper part's cells, without those on the lid.
struct UpperFaces {
  struct Inner : UpperFace {
    CellIndex neighbour;  ///< > cell
  };
  std::vector<Inner> inner;      ///< By cell, then by neighbour.
  std::vector<UpperFace> top;    ///< By cell,
  std::vector<UpperFace> sides;  ///< likewise.
};

/// Time and memory linear in the upper part: 112 bytes per cell, or little without the inner faces.
UpperFaces upper_faces(const ColumnMesh& mesh, bool with_inner = true);

/// Calls visit(chunk, faces) for the faces between two cells, each once, some of them at a time and
/// perhaps at the same time; what is in which chunk does not depend on threads. Takes 8 bytes per
/// cell. Precondition: fewer than 2^31 cells.
void visit_inner_faces(
    const ColumnMesh& mesh,
    const std::function<void(std::size_t, std::span<const UpperFaces::Inner>)>& visit);
/// Chunks are below this.
std::size_t inner_face_chunks(const ColumnMesh& mesh);

/// Calls visit(face, is_top) for those on the domain's boundary. Quick, for it looks at no others.
void visit_outer_faces(const ColumnMesh& mesh,
                       const std::function<void(const UpperFace&, bool)>& visit);

}  // namespace tetropolis
