// Coarse grids of the multigrid solver in the plan: columns are gathered, layers stay.
#pragma once

#include "laplace_level.h"

namespace tetropolis {

/// Aggregates each column with its strongly coupled neighbours (Vanek, Mandel & Brezina, Computing
/// 56, 1996) and smooths the piecewise constant interpolation once with the weighted graph's
/// Laplacian, so that constants stay constants. There are about a sixth as many coarse columns.
/// Deterministic; linear in the graph.
Interpolation coarsen(const LevelGraph& graph, const EdgeWeights& weights);

}  // namespace tetropolis
