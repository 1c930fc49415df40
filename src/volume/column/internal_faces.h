// Which cells of a column mesh share which faces: found by climbing, so writers stream.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// A CellFace of three corners. Those to prisms are there, too; those between prisms are not
/// (prism_faces.h).
struct InternalFace {
  CellIndex owner;
  CellIndex neighbour;
  std::array<NodeIndex, 3> nodes;
};

/// Gives the internal faces in upper-triangular order: by owner, then by neighbour. Refers to the
/// mesh, which must outlive it. Copies share nothing that changes: one per thread.
class InternalFaces {
 public:
  /// `cells` is cell_offsets(mesh) and must outlive this.
  InternalFaces(const ColumnMesh& mesh, const std::vector<CellIndex>& cells)
      : mesh_(mesh), cells_(cells) {}

  /// The faces whose owner is a cell over triangle t. Valid until the next call.
  const std::vector<InternalFace>& owned_over(TriangleIndex t);

 private:
  /// The triangle on the other side of an edge of triangle t, if its cells have higher numbers,
  /// and the cells in it that hold each segment of the edge's two columns.
  struct Beyond {
    bool exists = false;
    std::array<NodeIndex, 2> from{};                 ///< First node with cells beyond.
    std::array<std::vector<CellIndex>, 2> behind{};  ///< By node above `from`.
  };
  void look_beyond(TriangleIndex t, std::size_t i);

  const ColumnMesh& mesh_;
  const std::vector<CellIndex>& cells_;
  std::array<Beyond, 3> beyond_;  ///< Over the edge from corner i to corner i + 1.
  std::vector<InternalFace> faces_;
};

}  // namespace tetropolis
