// The stiffness matrix of the column mesh as bands; used by laplace.cpp and its tests only.
#pragma once

#include <cstddef>
#include <vector>

#include "tetropolis/volume/layered_mesh.h"

namespace tetropolis {

/// With n = K + 1:
///   edge[(2 * e) * n + k]       couples (a, k) with (b, k),      e = edge a < b
///   edge[(2 * e + 1) * n + k]   couples (a, k) with (b, k + 1),  0 for k = K
///   vertical[v * n + k]         couples (v, k) with (v, k + 1),  0 for k = K
///   diagonal[v * n + k]         minus the sum of the row; 1 for nodes without cells
struct StiffnessBands {
  std::vector<float> edge;
  std::vector<float> vertical;
  std::vector<float> diagonal;
};

/// Assembles the linear finite element stiffness matrix of the cells of `mesh`. The same bits for
/// any number of threads. Precondition: all vertical edges of cells are positive.
StiffnessBands assemble_stiffness(const LayeredMesh& mesh);

}  // namespace tetropolis
