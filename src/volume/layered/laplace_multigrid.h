// The preconditioner of the Laplace solver: a V-cycle over coarser and coarser columns.
#pragma once

#include <vector>

#include "laplace_level.h"

namespace tetropolis {

/// Smoothed aggregation of columns, with exact solves up the columns as smoother (damped block
/// Jacobi). Layers are never coarsened: coupling up a column is always solved for, and once columns
/// are as wide as the domain is high nothing else is left. The number of levels therefore grows
/// with the logarithm of the layer count, and the number of cycles to a given accuracy not at all.
class Multigrid {
 public:
  /// `matrix` (with pivots), `graph` and the vectors given later belong to the caller and are those
  /// of the finest level. `weights` couple its columns in the plan; `height` and `area` of the
  /// domain say when to stop.
  Multigrid(const LevelMatrix& matrix, const LevelGraph& graph, EdgeWeights weights, double height,
            double area);

  /// Of the smoother.
  float damping() const { return damping_; }

  /// Damps so much that the smoother is certain to converge on the finest level; false if it did
  /// before.
  bool make_safe();

  /// y = M^-1 b by one V-cycle; returns b.y. x holds the first half sweep on entry: solve_columns
  /// of b with damping(); what it holds afterwards does not matter.
  double apply_to_smoothed(const float* b, float* x, float* y);

 private:
  struct Level {
    CoarseGraph graph;
    LevelMatrix matrix;
    Interpolation to_finer;
    PaddedFloats b, x, y;
  };
  double cycle(std::size_t level, const float* b, float* x, float* y);

  const LevelMatrix& matrix_;
  LevelGraph graph_;
  float damping_;
  std::vector<Level> levels_;  ///< Coarser and coarser.
};

}  // namespace tetropolis
