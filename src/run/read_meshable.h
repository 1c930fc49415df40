// The input of `tetropolis mesh`.
#pragma once

#include "tetropolis/run/config.h"
#include "tetropolis/run/report.h"

#include "pipeline/stages.h"

namespace tetropolis {

/// Reads config.city and config.dtm, which may come from anywhere, and holds them against what a
/// mesh needs: units of metres, one reference system, elevations, terrain under all of the domain
/// (config.bounds, or what the files say), footprints that are valid, in the domain and
/// config.min_building_distance apart. Tells the report of the city. Throws Error(kInput) naming
/// file, building or node.
CityAndTerrain read_meshable(const Config& config, Report& report);

}  // namespace tetropolis
