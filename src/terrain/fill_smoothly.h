// Terrain between places of known height, far apart.
#pragma once

#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Gives every node whose value is NaN a height between those of the nodes around, however far away
/// these are: bilinear between the means of the known ones in squares of 2 nodes, where there are
/// none of 4, 8, ... ("pull-push" of Gortler, Grzeszczuk, Szeliski and Cohen, "The Lumigraph",
/// 1996). Slopes are about those from one known height to the next. fill_empty_nodes is for small
/// voids: half way between two heights it has a step. Precondition: at least one value is not NaN.
/// Guarantees: the others keep their bits; heights lie between the lowest and the highest of these,
/// up to rounding; the same bytes for any number of threads. Linear time and memory.
void fill_smoothly(Raster& raster);

}  // namespace tetropolis
