// Elevations that city models state, held against the terrain. Private to src/pipeline.
#pragma once

#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/domain.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Where models do not stand at this terrain, as those with all bases at 0, features lose their
/// `base`, with a warning ("model_off_terrain"): their heights then count from the ground. That is
/// where bases are further above or below it than buildings are high; medians by volume, since
/// models may have roofs as objects of their own. Local frame.
void match_to_terrain(const Raster& terrain, const Domain& domain, FootprintsInput& footprints,
                      std::vector<Warning>& warnings);

}  // namespace tetropolis
