#include "tet_shape.h"

#include "tet_cosines.h"

namespace tetropolis {

TetShape tet_shape(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3) {
  const TetCosines shape = tet_cosines(p0, p1, p2, p3);
  return {shape.volume, angle_deg(shape.greatest), angle_deg(shape.least), shape.aspect_ratio};
}

}  // namespace tetropolis
