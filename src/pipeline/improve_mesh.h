// From columns that are valid to columns above the floor of quality.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "make_columns.h"
#include "memory.h"

namespace tetropolis {

struct MeshQuality {
  CellQuality cells;
  FaceQuality faces;
};

/// Measures the mesh and, as far as it is below the floor, moves nodes of columns, then cuts the
/// terrain back: exact terrain comes first, so nothing is cut where the floor is met without. Keeps
/// only what makes it better; the columns of uniform layers are as asked for and stay. `volume` is
/// told of columns improved and of the least gap. Work is bounded, so the floor may stay missed.
MeshQuality improve_mesh(const MeshCityOptions& options, const Raster& dtm, const CitySize& size,
                         Columns& columns, StepClock& clock, VolumeMeshFacts& volume);

/// Adds warnings of what is below the floor.
void warn_below_floor(const MeshCityOptions& options, const ColumnMesh& mesh,
                      const MeshQuality& quality, std::vector<Warning>& warnings);

}  // namespace tetropolis
