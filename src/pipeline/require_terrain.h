// What a terrain has to be before anything is sampled from it.
#pragma once

#include <string>

#include "tetropolis/city/city_model.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Throws Error(kInput), naming `source`, unless the raster has nodes, a value for each that is an
/// elevation (elevations.h), a place and a step.
void require_raster(const Raster& raster, const std::string& source);

/// Throws Error(kInput), naming `source`, unless the terrain lies under all of the city's domain
/// but for a fringe of one step. A single node is level ground everywhere. Precondition:
/// require_raster.
void require_terrain_under(const CityModel& city, const Raster& terrain, const std::string& source);

}  // namespace tetropolis
