// The input of `tetropolis mesh`.
#pragma once

#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

struct MeshableInput {
  CityModel city;
  Raster terrain;
  CityFacts facts;
};

/// Reads config.city and config.dtm, which may come from anywhere, and holds them against what a
/// mesh needs: units of metres, one reference system, elevations, terrain under all of the domain
/// (config.bounds, or what the files say), footprints as require_meshable asks for. Adds warnings.
/// Throws Error(kInput) naming file, building or node.
MeshableInput read_meshable(const Config& config, std::vector<Warning>& warnings);

}  // namespace tetropolis
