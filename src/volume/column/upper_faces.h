// The faces of a mesh's upper part.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// The ground vertex that nodes of the upper part and ends of columns are over.
class UpperNodes {
 public:
  explicit UpperNodes(const ColumnMesh& mesh) : mesh_(mesh) {}
  VertexIndex vertex(NodeIndex n) const {
    if (n >= mesh_.column_nodes())
      return mesh_.upper.vertex[static_cast<std::size_t>(n.value() - mesh_.column_nodes())];
    return VertexIndex(std::upper_bound(mesh_.first.begin(), mesh_.first.end(), n) -
                       mesh_.first.begin() - 1);
  }
  Point3 operator[](NodeIndex n) const {
    if (n >= mesh_.column_nodes())
      return mesh_.upper.points[static_cast<std::size_t>(n.value() - mesh_.column_nodes())];
    return position(mesh_, vertex(n), n);
  }

 private:
  const ColumnMesh& mesh_;
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

/// Time and memory linear in the upper part: 160 bytes per cell, or 32 without the inner faces.
UpperFaces upper_faces(const ColumnMesh& mesh, bool with_inner = true);

/// The same faces one by one, by their highest node, without keeping them: 32 bytes per cell.
void visit_upper_faces(const ColumnMesh& mesh,
                       const std::function<void(const UpperFaces::Inner&)>& inner,
                       const std::function<void(const UpperFace&, bool is_top)>& outer);

}  // namespace tetropolis
