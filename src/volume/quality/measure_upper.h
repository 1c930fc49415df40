// Quality of the cells and faces of a mesh's upper part.
#pragma once

#include <cstddef>

#include "tetropolis/volume/column/column_mesh.h"

#include "measured_mesh.h"

namespace tetropolis {

/// Adds them to the `quality` of the columns below, and those of the faces on the lid. Lists the
/// `worst` worst cells of both.
void add_upper_quality(const ColumnMesh& mesh, std::size_t worst, MeshQuality& quality);

}  // namespace tetropolis
