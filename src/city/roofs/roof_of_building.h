// The roof of one building, from its points to its parts. Private to src/city.
#pragma once

#include "tetropolis/city/roofs.h"

#include "city/roofs/finish_parts.h"
#include "city/roofs/roof_input.h"

namespace tetropolis {

/// `fallback_height`, `lowest`: elevations of roofs without points, and that no roof goes below.
FinishedRoof roof_of_building(const RoofInput& input, const RoofOptions& options,
                              double fallback_height, double lowest);

}  // namespace tetropolis
