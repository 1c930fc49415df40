// Ground where no terrain is given, but buildings that state where they stand. Private to the
// library.
#pragma once

#include <optional>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/build_city.h"

namespace tetropolis {

/// Nodes every `step` metres over `box` (CRS coordinates): inside a footprint at its base, the
/// lowest where several lie one above the other, between them as fill_smoothly makes it. Bases that
/// are not on the ground do not count: of what lies above others with half of its plan, or beside a
/// larger building more than a storey above its base. `origin`: of the raster's frame. With a
/// warning ("ground_of_bases"); none in `box` states a base: nothing.
std::optional<TerrainInput> ground_of_bases(const FootprintsInput& footprints, const Bounds2& box,
                                            Point2 origin, double step,
                                            std::vector<Warning>& warnings);

}  // namespace tetropolis
