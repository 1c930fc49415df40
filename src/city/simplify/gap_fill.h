// Places that changing single vertices does not repair: gaps and slots are filled, thin arms and
// necks are cut or widened.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "city/outline.h"
#include "repair.h"

namespace tetropolis {

/// Changes of one polygon: its next shape is (polygon and all `fill`) without all `cut`.
struct FillsAndCuts {
  std::vector<Polygon> fill;
  std::vector<Polygon> cut;
  std::vector<Polygon> widen;  ///< What to add in place of each of `cut` if cutting loses too much.
  std::int64_t widened = 0;    ///< How many of `fill` widen a neck.
  bool are_hulls = false;      ///< `fill` are hulls of surroundings, no gaps.
};

/// Fills and cuts for pairs of one polygon, per polygon of the outline. A pair whose connecting
/// segment runs outside is filled; inside, it is cut or widened, whichever changes less area. Cuts
/// that touch a filling, or lie inside one, are left for a later round. `epsilon` and `reach` (>=
/// epsilon) are steps; they end where the gap becomes wider than `reach`. Pairs of neighbouring
/// vertices (short edges) are left out, and of a vertex among many walls all but its nearest dozen.
/// Precondition: the pairs of a vertex follow each other.
std::vector<FillsAndCuts> fills_and_cuts(const Outline& outline, const std::vector<NearPair>& pairs,
                                         double epsilon, double reach);

/// Per polygon: convex hulls of its vertices within `radius` of each too close vertex.
std::vector<FillsAndCuts> hulls_around(const Outline& outline, const std::vector<NearPair>& pairs,
                                       double radius);

}  // namespace tetropolis
