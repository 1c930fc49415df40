// Quality of the prisms of a column mesh's layers, as solvers of finite volumes see it.
#pragma once

#include <cstdint>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// As OpenFOAM's checkMesh measures them. Dihedral angles say nothing of flat prisms.
struct PrismQuality {
  std::int64_t cells = 0;
  double volume = 0;          ///< Cubic metres.
  double share_as_asked = 0;  ///< Of the open ground's area, by vertex: where the lowest
                              ///< layer is as high as was asked for, to a millimetre.
  double least_height = 0;    ///< Shortest upright edge, metres.
  std::int64_t faces = 0;     ///< Between two cells, one of them a prism;
  std::int64_t above_70 = 0;  ///< of them more than 70 degrees non-orthogonal.
  double max_non_orthogonality_deg = 0;
  double mean_non_orthogonality_deg = 0;  ///< Arc cosine of the mean cosine.
  double max_skewness = 0;                ///< Of all faces of prisms.
  double max_aspect_ratio = 0;
  double least_flatness = 1;  ///< Area of a face over that of the triangles it is made of
                              ///< around its centre; 1: it is plane.
};

/// Over all prisms of the mesh, which is valid (require_valid); nothing without. `first`: height
/// asked for of the lowest layer, metres. The same bits for any number of threads.
PrismQuality measure_prisms(const ColumnMesh& mesh, double first);

}  // namespace tetropolis
