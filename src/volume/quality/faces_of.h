// The faces of single stacks and edges, one by one.
#pragma once

#include <cstddef>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/face_quality.h"

namespace tetropolis {

/// Those between the cells over triangle t.
FaceQuality faces_over(const ColumnMesh& mesh, TriangleIndex t);

/// Of the faces at the two ends of these cells that are on the boundary: the greatest.
double skewness_at_ends(const ColumnMesh& mesh, TriangleIndex t);

/// Those over edge e, between the cells on its two sides and, where there are none on one side, on
/// the boundary.
FaceQuality faces_beside(const ColumnMesh& mesh, EdgeIndex e);

}  // namespace tetropolis
