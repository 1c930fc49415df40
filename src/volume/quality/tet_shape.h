// Shape of a tetrahedron: dihedral angles and aspect ratio.
#pragma once

#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct TetShape {
  double volume = 0;            ///< Signed, cubic metres.
  double min_dihedral_deg = 0;  ///< Least of the six dihedral angles.
  double max_dihedral_deg = 0;  ///< Greatest of the six.
  double aspect_ratio = 0;      ///< Longest edge over 2 sqrt(6) times the inradius: 1 for the
                                ///< regular tet (Stimpson et al., The Verdict Library, 2007).
};

/// Of a tet of zero or negative volume, the angles and the ratio are those of the flat or mirrored
/// one.
TetShape tet_shape(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3);

}  // namespace tetropolis
