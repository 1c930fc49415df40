// Shape of a tetrahedron: dihedral angles and aspect ratio.
#pragma once

#include "tetropolis/geometry/types.h"

#include "volume/quality/tet_cosines.h"

namespace tetropolis::testing {

struct TetShape {
  double volume = 0;            ///< Signed, cubic metres.
  double min_dihedral_deg = 0;  ///< Least of the six dihedral angles.
  double max_dihedral_deg = 0;  ///< Greatest of the six.
  double aspect_ratio = 0;      ///< Longest edge over 2 sqrt(6) times the inradius: 1 for the
                                ///< regular tet (Stimpson et al., The Verdict Library, 2007).
};

/// Of a tet of zero or negative volume, the angles and the ratio are those of the flat or mirrored
/// one.
inline TetShape tet_shape(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3) {
  const TetCosines shape = tet_cosines(p0, p1, p2, p3);
  return {shape.volume, angle_deg(shape.greatest), angle_deg(shape.least), shape.aspect_ratio};
}

}  // namespace tetropolis::testing
