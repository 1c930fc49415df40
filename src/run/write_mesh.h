// The files of step 3.6.
#pragma once

#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Writes volume, boundary and surface in all formats asked for. `boundary` is that of `mesh`,
/// `buildings` those of its city model.
void write_mesh(const Config& config, const ColumnMesh& mesh, const SurfaceMesh& boundary,
                std::span<const Building> buildings, const Placement& placement, OutputFolder& out,
                const Progress& progress);

}  // namespace tetropolis
