// The regions of a written volume against its city model.
#pragma once

#include <array>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Whether `region` names, for every cell, the building in whose footprint the cell's centre lies,
/// or -1, as it may above that building's lowest roof, too; a mesh without `region` is a violation.
/// `shift` is added to the mesh's coordinates to get to the local frame of `city`.
std::vector<Violation> check_regions(const TetMesh& mesh, std::array<double, 3> shift,
                                     const CityModel& city);

}  // namespace tetropolis
