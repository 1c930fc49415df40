// The faces of single stacks and edges, one by one.
#pragma once

#include <cstddef>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/face_quality.h"

namespace tetropolis {

/// Those between the cells over triangle t, and on the boundary at their two ends.
FaceQuality faces_over(const ColumnMesh& mesh, TriangleIndex t);

/// Those over edge e, between the cells on its two sides and, where there are none on one side, on
/// the boundary.
FaceQuality faces_beside(const ColumnMesh& mesh, EdgeIndex e);

}  // namespace tetropolis
