// Lowest points of cells that are below the ground. Private to src/terrain.
#pragma once

#include "morphology.h"

namespace tetropolis {

/// Empties the cells of `grid` whose lowest point is a low outlier (see filter_ground). `all` has
/// the lowest points of the cells in footprints, too, and is otherwise the same. `cell`, `spacing`:
/// metres, side of a cell and mean distance of points. The same for any number of threads; linear
/// in the cells.
void remove_low_outliers(HeightGrid& grid, HeightGrid all, double cell, double spacing);

}  // namespace tetropolis
