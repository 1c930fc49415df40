// The parts of a city's buildings in a row, as meshing numbers them.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/pipeline/mesh_city.h"

namespace tetropolis {

/// Entry r of both is about region r of the ground mesh.
struct CityParts {
  std::vector<PartOutline> outlines;  ///< Of the city: valid as long as it is.
  std::vector<RoofPlane> roofs;
};

/// All parts of all buildings; of a building without any, and of those in `blocks` (ascending), the
/// footprint at h_roof. Laplace problems know one roof per building: where they are solved, all
/// buildings are blocks.
CityParts parts_of(const CityModel& city, const MeshCityOptions& options,
                   std::span<const BuildingIndex> blocks = {});

}  // namespace tetropolis
