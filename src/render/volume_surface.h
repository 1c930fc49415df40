// The surface of a volume that comes without one. Private to src/render.
#pragma once

#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Ground, roofs and walls of a volume: its faces with one cell, less the top (faces that look up)
/// and the sides (vertical faces below the top). Roofs are below cells over buildings. Walls know
/// no building. Precondition: no cell is above solid ground that is above another cell.
SurfaceMesh surface_of(const TetMesh& mesh);

}  // namespace tetropolis
