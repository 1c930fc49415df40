// A patch for the roofs and one for the walls of each building.
#pragma once

#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// `boundary` with its roofs and walls divided by building: their faces move to "roof_ID" and
/// "wall_ID", for each building that has such faces, roofs before walls, each in the order of
/// `buildings`, numbered after all other patches. "roof" and "wall" stay, without faces. Faces keep
/// their order within a patch; points stay as they are.
///
/// Names have letters, digits, '_' and '-' and 32 characters at most, which every format takes:
/// other characters of an id become '_', and one that is too long or not unique ends with '.' and
/// the building's number. Precondition: `buildings` are those of the city.
SurfaceMesh divide_by_building(const SurfaceMesh& boundary, std::span<const Building> buildings);

}  // namespace tetropolis
