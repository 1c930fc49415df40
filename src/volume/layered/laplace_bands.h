// The stiffness matrix of the column mesh as bands; used by laplace.cpp and its tests only.
#pragma once

#include <vector>

#include "laplace_level.h"
#include "layered_mesh.h"

namespace tetropolis {

/// Whether all layers of `mesh` are alike: nothing trimmed, and every column the same with even
/// spacing.
bool is_uniform(const LayeredMesh& mesh);

struct Stiffness {
  LevelMatrix matrix;   ///< Without diagonal and pivots.
  EdgeWeights weights;  ///< Cotangent weights of the ground mesh's edges, less the share of the
                        ///< height that is trimmed.
};

/// Assembles `edge` and `vertical` of the linear finite element stiffness matrix of the cells of
/// `mesh`, for all rows and before anything is known of given values. `uniform` asks for bands of
/// two numbers, of layers between bottom and top and of the top; precondition: is_uniform(mesh).
/// The same bits for any number of threads. Precondition: all vertical edges of cells are positive.
Stiffness assemble_stiffness(const LayeredMesh& mesh, bool uniform);

/// What solve_laplace starts from: fills `diagonal`, minus the sum of the row for every node, and
/// returns minus A u, u in the mesh's layout. Constants are in the kernel of the matrix.
PaddedFloats complete_diagonal(const LayeredMesh& mesh, const std::vector<float>& u,
                               LevelMatrix& matrix);

}  // namespace tetropolis
