// Nodes of prisms moved where faces are far from orthogonal or skewed.
#pragma once

#include <cstdint>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/prism_quality.h"

namespace tetropolis {

/// What faces may be.
struct PrismAims {
  double non_orthogonal_deg = 60;
  double skewness = 1.9;
};

inline bool is_within(const PrismQuality& quality, const PrismAims& aims) {
  return quality.max_non_orthogonality_deg <= aims.non_orthogonal_deg &&
         quality.max_skewness <= aims.skewness;
}

/// Moves nodes between floors and top up or down where faces are beyond the aims, so that the sum
/// of what they are above them, squared, falls: node by node, or one with less and less of those
/// above it, in a bounded number of rounds.
/// Floors, top and the boundary layers stay; no segment of a column becomes shorter than two fifths
/// of what it was. What happens at a place depends on the faces around it. Returns how many
/// columns have moved nodes. Precondition: `mesh` is all prisms (make_whole).
std::int64_t improve_prisms(ColumnMesh& mesh, const PrismAims& aims);

}  // namespace tetropolis
