// What is low and narrow between higher ground. Private to src/terrain.
#pragma once

#include "cells.h"
#include "morphology.h"

namespace tetropolis {

/// Fills what is low, narrow and little deeper than a storey: light wells, basement stairs,
/// ditches. Where they are closer to each other than the window is wide, an opening would take the
/// ground between them for an object. Alleys between houses are deeper. What is beside a void is as
/// narrow as if that were high. Where much is low and little wide within `window` metres it is the
/// ground between rows of low objects (garages, sheds, hedges, greenhouses) that is low; it stays.
/// Cells without a value are NaN, before and after. Linear in the cells.
void fill_depressions(HeightGrid& grid, const Frame& frame, double window);

}  // namespace tetropolis
