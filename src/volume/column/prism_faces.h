// Which prisms of a column mesh share which faces.
#pragma once

#include <vector>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/column/explicit_mesh.h"

namespace tetropolis {

/// All faces between two prisms (`first_prism`: number of the first prism) in upper-triangular
/// order: by owner, then by neighbour. Those between prisms and tets are the floors of stacks: they
/// belong to the tets, whose numbers are lower.
std::vector<CellFace> prism_faces(const ColumnMesh& mesh, CellIndex first_prism);

}  // namespace tetropolis
