// The Laplace problem of the smoothing steps, on the column mesh.
//
// Linear finite elements on the real tets of the columns. Because all columns share their layers, a
// ground-mesh edge a < b couples node (a, k) with (b, k) and, along the prisms' diagonals, with
// (b, k + 1), and nothing else: the matrix is two bands of K + 1 numbers per edge and one per
// vertex, with no column indices. Where all layers are still alike, as in the first of the two
// solves, two numbers stand for a band.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/progress.h"

#include "layered_mesh.h"

namespace tetropolis {

/// What the tolerance means for the mesh: the first guesses of the smoothing steps are right to
/// within about a layer, so the nodes end up right to about the tolerance times the layer height in
/// the mean, and to some tens of times that in the worst of gaps between buildings. On the city of
/// 3,096 buildings at h = 10 m, against the exact solution (step 3.5; dihedral angles in degrees):
///
///   tolerance   iterations   mean error   worst error   least angle   0.1 % below   greatest
///   0.1         2 + 2        40 mm        1.5 m         2.996         6.185         171.40
///   0.01        4 + 3        12 mm        0.6 m         2.953         6.175         171.40
///   0.001       5 + 5        2 mm         0.3 m         2.940         6.175         171.40
///   0           -            -            -             2.941         6.175         171.40
struct LaplaceOptions {
  double tolerance = 1e-3;    ///< Stop when the estimated energy norm of the error has fallen by
                              ///< this.
  int max_iterations = 1000;  ///< > 0.
  bool fixed_top = true;      ///< Dirichlet top; otherwise homogeneous Neumann.
};

/// What a solve did. `relative_residual` is sqrt(r.Mr) over its value at the initial guess, M being
/// the preconditioner, a close approximation of the inverse: this estimates the energy norm of the
/// error. 0 if the guess was already exact.
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
/// Conjugate gradients, preconditioned by a multigrid cycle that solves exactly up each column and
/// coarsens in the plan only (smoothed aggregation: Vanek, Mandel & Brezina, Computing 56, 1996;
/// Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., 9.2 and 13). About five iterations
/// reach the default tolerance whatever the size of the mesh, so time and memory are linear in it.
/// The result has the same bits for any number of threads.
/// Preconditions: all vertical edges of cells are positive; u has the mesh's node layout.
/// Throws Cancelled.
SolverReport solve_laplace(const LayeredMesh& mesh, std::vector<float>& u,
                           const LaplaceOptions& options, const Progress& progress = {});

}  // namespace tetropolis
