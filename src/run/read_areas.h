// Files of polygons that are no buildings: areas of sizes, of the ground, the domain.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// All polygons of a file in the coordinates of `crs`, that of the city, which they are taken to be
/// in if the file states none; with their `attributes` if asked for. Adds warnings, also if none
/// meets `domain` (CRS coordinates; empty: not known). Errors: those of read_footprints; kInput for
/// an OpenStreetMap extract or a city model, of which only buildings would be read.
FootprintsInput read_areas(const std::string& file, const std::string& crs, const Bounds2& domain,
                           bool attributes, std::vector<Warning>& warnings);

/// Warns that an entry of a setting, with areas in a box, is without effect ("areas_outside").
void warn_of_areas_outside(const std::string& entry, const Bounds2& areas, const Bounds2& domain,
                           std::vector<Warning>& warnings);

}  // namespace tetropolis
