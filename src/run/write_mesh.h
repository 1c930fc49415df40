// The files of step 3.6.
#pragma once

#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"

namespace tetropolis {

/// Writes volume, boundary and surface in all formats asked for. `buildings`: those of the mesh's
/// city model.
void write_mesh(const Config& config, const CityMesh& mesh, std::span<const Building> buildings,
                OutputFolder& out, const Progress& progress);

}  // namespace tetropolis
