// The Laplace problem of the smoothing steps, on the column mesh.
//
// Linear finite elements on the real tets of the columns. Because all columns share their layers, a
// ground-mesh edge a < b couples node (a, k) with (b, k) and, along the prisms' diagonals, with
// (b, k + 1), and nothing else: the matrix is two bands of K + 1 numbers per edge and one per
// vertex, with no column indices.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/volume/layered_mesh.h"

namespace tetropolis {

struct LaplaceOptions {
  double tolerance = 1e-3;    ///< Stop when the preconditioned residual norm has fallen by this.
  int max_iterations = 1000;  ///< > 0.
  bool fixed_top = true;      ///< Dirichlet top; otherwise homogeneous Neumann.
};

/// What a solve did. `relative_residual` is sqrt(r.Mr) over its value at the initial guess, M being
/// the preconditioner; 0 if the guess was already exact.
struct SolverReport {
  std::int64_t unknowns = 0;
  int iterations = 0;
  double relative_residual = 0;
  bool converged = true;
};

/// Solves -div grad u = 0 on the mesh as it stands, u[v * (K + 1) + k] in single precision.
///
/// Dirichlet values are taken from `u` on entry at the lowest node of every column (first_node), at
/// roofs (roof_layer) and, if asked, at the top; all else is natural (homogeneous Neumann), and `u`
/// on entry is the initial guess there. Nodes without cells keep their value.
/// Conjugate gradients, preconditioned by an exact solve up each column (block Jacobi with
/// tridiagonal blocks; Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., 9.2 and 10.5).
/// The result has the same bits for any number of threads.
/// Preconditions: all vertical edges of cells are positive; u has the mesh's node layout.
/// Throws Cancelled.
SolverReport solve_laplace(const LayeredMesh& mesh, std::vector<float>& u,
                           const LaplaceOptions& options, const Progress& progress = {});

}  // namespace tetropolis
