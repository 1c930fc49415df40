// Files of polygons that are no buildings: areas of sizes, of the ground, the domain.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// All polygons of a file in the coordinates of `crs`, that of the city, which they are taken to be
/// in if the file states none; with their `attributes` if asked for. Adds warnings. Errors: those of read_footprints; kInput for an OpenStreetMap extract or a city model,
/// of which only buildings would be read.
FootprintsInput read_areas(const std::string& file, const std::string& crs, bool attributes,
                           std::vector<Warning>& warnings);

}  // namespace tetropolis
