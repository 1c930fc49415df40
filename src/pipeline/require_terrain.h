// What a terrain has to be before anything is sampled from it.
#pragma once

#include <string>

#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Throws Error(kInput), naming `source`, unless the raster has nodes, a value for each that is an
/// elevation (elevations.h), a place and a step.
void require_raster(const Raster& raster, const std::string& source);

}  // namespace tetropolis
