// How far the buildings of the footprints reach.
#pragma once

#include <span>

#include "tetropolis/geometry/types.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// The box of the footprints that make a building, in their coordinates: a feature that will be
/// dropped (a coordinate of 1e300, no area), or a spike without width that cleaning takes away,
/// does not widen the domain. Empty if there is no such footprint. Only footprints at the sides of
/// the box are cleaned for that: of sound files, four.
Bounds2 footprint_extent(std::span<const Footprint> features, double parallel_tolerance);

/// Makes it the bounds of the input, once; where no footprint is usable they stay, and they are
/// told of later.
void bound_by_extent(FootprintsInput& footprints, double parallel_tolerance);

}  // namespace tetropolis
