// The dihedral angles of a tet as cosines: what loops over many tets need of its shape.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tetropolis/geometry/types.h"

#include "core/infinity.h"
#include "core/units.h"
#include "geometry/vec3.h"

namespace tetropolis {

/// The angle that a cosine, rounded beyond 1 perhaps, belongs to.
inline double angle_deg(double cosine) {
  return to_degrees(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

struct TetCosines {
  double volume;    ///< Signed.
  double greatest;  ///< Cosine of the least dihedral angle
  double least;     ///< and of the greatest.
  double aspect_ratio;
};

inline TetCosines tet_cosines(const Point3& p0, const Point3& p1, const Point3& p2,
                              const Point3& p3) {
  const Point3 e01 = minus(p1, p0), e02 = minus(p2, p0), e03 = minus(p3, p0);
  const Point3 e12 = minus(p2, p1), e13 = minus(p3, p1), e23 = minus(p3, p2);
  // Normals of the faces opposite to p0 .. p3, all pointing outwards (or all inwards), length twice
  // the face's area.
  const std::array<Point3, 4> normal = {cross(e12, e13), cross(e03, e02), cross(e01, e03),
                                        cross(e02, e01)};
  std::array<double, 4> per_length{};
  double twice_area = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double length = std::sqrt(dot(normal[i], normal[i]));
    twice_area += length;
    per_length[i] = length > 0 ? 1 / length : 0;
  }
  TetCosines shape{};
  shape.least = 1;
  shape.greatest = -1;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = -dot(normal[i], normal[j]) * (per_length[i] * per_length[j]);
      shape.least = std::min(shape.least, cosine);
      shape.greatest = std::max(shape.greatest, cosine);
    }
  double longest2 = 0;
  for (const Point3* e : {&e01, &e02, &e03, &e12, &e13, &e23})
    longest2 = std::max(longest2, dot(*e, *e));
  const double six_volumes = -dot(normal[3], e03);
  shape.volume = six_volumes / 6;
  // The inradius is three volumes over the area.
  shape.aspect_ratio =
      six_volumes != 0 ? std::sqrt(longest2 / 24) * twice_area / std::abs(six_volumes) : kInfinity;
  return shape;
}

}  // namespace tetropolis
