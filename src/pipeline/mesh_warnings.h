// What a run warns of when it has made a mesh.
#pragma once

#include "tetropolis/run/config.h"
#include "tetropolis/run/report.h"

#include "volume/excavate/reach_quality_floor.h"

namespace tetropolis {

/// Warns of terrain that was lowered, at walls or by excavation.
void warn_of_lowered_ground(const ColumnPlan& plan, const ExcavationSources& excavated,
                            Report& report);

/// Warns of cells and faces below the floor of quality.
void warn_below_floor(const Config& config, const ColumnMesh& mesh, const MeshQuality& quality,
                      Report& report);

}  // namespace tetropolis
