// The guard that makes every cell valid.
#pragma once

#include <cstdint>

#include "layered_mesh.h"

namespace tetropolis {

struct MonotoneOptions {
  double gap_share = 0.25;  ///< In (0, 1): a layer is at least this share of the even spacing of
                            ///< the column's piece it lies in, or of a ladder's; nine tenths of
                            ///< a ladder's between ground and roof.
  bool fixed_top = true;    ///< The top layer keeps its height.
  double layer_height = 0;  ///< Metres, > 0: the even spacing assumed below a free top.
};

struct MonotoneReport {
  std::int64_t moved = 0;  ///< Nodes the guard had to move.
  double min_gap = 0;      ///< Shortest vertical edge of any cell afterwards, metres.
};

/// Moves free nodes up or down until every vertical edge of every cell is at least gap_share times
/// the even spacing between the fixed nodes around it. Fixed nodes (lowest node, roof, top if
/// fixed) keep their exact height. By the identity in layered_mesh.h all cells are then positive.
///
/// In a piece of m layers between fixed heights a < b, g = gap_share * (b - a) / m. A sweep up
/// makes z[k] >= z[k-1] + g, a sweep down from b makes z[k] <= z[k+1] - g; after the first, z[k] >=
/// a + k g, and a + k g <= b - (m - k) g because gap_share <= 1, so the second cannot undo it.
///
/// Precondition: in every column the fixed heights increase. Throws Error(kGuarantee) naming the
/// vertex otherwise.
MonotoneReport make_monotone(LayeredMesh& mesh, const MonotoneOptions& options);

}  // namespace tetropolis
