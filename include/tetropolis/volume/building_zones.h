// A zone for the cells above each building.
#pragma once

#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// `zones`, which are zone_cells() of `mesh`, and after them a zone "over_ID" for each building
/// with cells above it: those that write_vtu gives the region of the building, from its roof up to
/// the lid. Cells that have a zone keep it. Names are as in divide_by_building(), leaf area
/// densities 0. Precondition: `buildings` are those of the city.
CellZones zone_buildings(const ColumnMesh& mesh, CellZones zones,
                         std::span<const Building> buildings);

}  // namespace tetropolis
