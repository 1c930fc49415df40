// Which prisms of a column mesh share which faces.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// A face between two prisms: its normal (right-hand rule) leaves `owner` for `neighbour`, and
/// owner < neighbour.
struct PrismFace {
  CellIndex owner;
  CellIndex neighbour;
  std::array<NodeIndex, 4> nodes;
  std::size_t corners;  ///< 3 or 4 of them.
};

/// All of them (`first_prism`: number of the first prism) in upper-triangular order: by owner, then
/// by neighbour. Those between prisms and tets are the floors of stacks: they belong to the tets,
/// whose numbers are lower.
std::vector<PrismFace> prism_faces(const ColumnMesh& mesh, CellIndex first_prism);

}  // namespace tetropolis
