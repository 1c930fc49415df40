// The matrix of a coarse level.
#pragma once

#include "laplace_level.h"

namespace tetropolis {

struct CoarseLevel {
  CoarseGraph graph;
  LevelMatrix matrix;
  EdgeWeights weights;
};

/// P^T A P with its graph, and its couplings added up along each edge as weights. Row by row, with
/// the same bits for any number of threads.
CoarseLevel coarse_level(const LevelMatrix& fine, const LevelGraph& graph, const Interpolation& p);

/// Fills inverse_pivots from vertical and diagonal; a zero on the diagonal marks a node whose value
/// is given.
void invert_pivots(LevelMatrix& matrix, std::size_t columns);

}  // namespace tetropolis
