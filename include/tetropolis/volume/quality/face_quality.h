// Quality of the faces of a column mesh's cells, as solvers of finite volumes see it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Shape of a face between two cells as OpenFOAM's checkMesh measures it.
struct FaceShape {
  double non_orthogonality_deg = 0;  ///< Between the face's normal and the line of cell centres.
  double skewness = 0;  ///< Distance of the face's centre from where that line meets its plane,
                        ///< over the face's extent in this direction (at least a fifth of the
                        ///< distance of the cell centres).
};

/// `c0`, `c1`: centres of the cells on both sides, not in the face's plane.
FaceShape face_shape(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1);

/// Skewness of a face on the boundary, as checkMesh measures it (primitiveMeshTools,
/// boundaryFaceSkewness): the distance of its centre from the foot of the perpendicular from the
/// cell's centre, over the face's extent in this direction (at least 0.4 of the perpendicular).
double boundary_skewness(const std::array<Point3, 3>& face, const Point3& cell_centre);

/// Degrees; what OpenFOAM's checkMesh calls severe above.
inline constexpr double kMostNonOrthogonal = 70;

/// What OpenFOAM's checkMesh takes for too skewed from here on.
inline constexpr double kMostSkewed = 4;

struct FaceQuality {
  std::int64_t faces = 0;     ///< Internal ones.
  std::int64_t above_70 = 0;  ///< Of them more than kMostNonOrthogonal.
  FaceShape worst;            ///< Greatest non-orthogonality of these, and greatest skewness of
                              ///< any face, on the boundary too.
};

/// Over all faces of the mesh, which is valid (require_valid). The same bits for any number of
/// threads.
FaceQuality measure_faces(const ColumnMesh& mesh);

}  // namespace tetropolis
