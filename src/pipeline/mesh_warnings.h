// What a run warns of when it has made a mesh.
#pragma once

#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/pipeline/mesh_city.h"

#include "volume/excavate/reach_quality_floor.h"

namespace tetropolis {

/// Warns of terrain that was lowered, at walls or by excavation.
void warn_of_lowered_ground(const ColumnPlan& plan, const ExcavationSources& excavated,
                            std::vector<Warning>& warnings);

/// Warns of canopies that no cell is in.
void warn_of_canopies(const CellZones& zones, std::vector<Warning>& warnings);

/// Warns of faces of prisms that are too slanting for many solvers.
void warn_of_prisms(const PrismQuality& prisms, std::vector<Warning>& warnings);

/// Warns of cells and faces below the floor of quality. `scale`: GroundMeshFacts::size_scale.
void warn_below_floor(const MeshCityOptions& options, double scale, const MeshQuality& quality,
                      std::vector<Warning>& warnings);

}  // namespace tetropolis
