// Tets and faces in loops that become vectors: the formulas of tet_cosines() and face_shape(), to
// the bit where these tell figures of tets.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/wide.h"

namespace tetropolis::lanes {

TETROPOLIS_INLINE double greater(double a, double b) { return a < b ? b : a; }
TETROPOLIS_INLINE double lesser(double a, double b) { return b < a ? b : a; }

/// Rows are filled up to whole vectors of so many.
inline constexpr std::size_t kWidth = 4;
constexpr std::size_t filled_up(std::size_t count) {
  return (count + kWidth - 1) / kWidth * kWidth;
}

// Not arrays: loops over these would not become vectors.
struct Vector {
  double x, y, z;
};
/// Point k of three rows, `stride` apart.
TETROPOLIS_INLINE Vector point(const double* rows, std::size_t stride, std::size_t k) {
  return {rows[k], rows[stride + k], rows[2 * stride + k]};
}
TETROPOLIS_INLINE Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
TETROPOLIS_INLINE Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
TETROPOLIS_INLINE double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
TETROPOLIS_INLINE double per(double length) { return length > 0 ? 1 / length : 0; }

struct Tet {
  double greatest, least;  // cosines of the least dihedral angle and of the greatest
  double twice_area, six_volumes;
};

TETROPOLIS_INLINE Tet measure_tet(Vector p0, Vector p1, Vector p2, Vector p3) {
  const Vector e01 = p1 - p0, e02 = p2 - p0, e03 = p3 - p0;
  const Vector e12 = p2 - p1, e13 = p3 - p1;
  const Vector n0 = cross(e12, e13), n1 = cross(e03, e02);
  const Vector n2 = cross(e01, e03), n3 = cross(e02, e01);
  const double l0 = std::sqrt(dot(n0, n0)), l1 = std::sqrt(dot(n1, n1));
  const double l2 = std::sqrt(dot(n2, n2)), l3 = std::sqrt(dot(n3, n3));
  const double q0 = per(l0), q1 = per(l1), q2 = per(l2), q3 = per(l3);
  const double c01 = -dot(n0, n1) * (q0 * q1), c02 = -dot(n0, n2) * (q0 * q2);
  const double c03 = -dot(n0, n3) * (q0 * q3), c12 = -dot(n1, n2) * (q1 * q2);
  const double c13 = -dot(n1, n3) * (q1 * q3), c23 = -dot(n2, n3) * (q2 * q3);
  return {greater(greater(greater(c01, c02), greater(c03, c12)), greater(c13, c23)),
          lesser(lesser(lesser(c01, c02), lesser(c03, c12)), lesser(c13, c23)), l0 + l1 + l2 + l3,
          -dot(n3, e03)};
}

TETROPOLIS_INLINE Vector centre_of(Vector p0, Vector p1, Vector p2, Vector p3) {
  return {(p0.x + p1.x + p2.x + p3.x) / 4, (p0.y + p1.y + p2.y + p3.y) / 4,
          (p0.z + p1.z + p2.z + p3.z) / 4};
}

/// Cosine of non-orthogonality of the face a - b - c between cells with these centres.
TETROPOLIS_INLINE double straightness(Vector a, Vector b, Vector c, Vector c0, Vector c1) {
  const Vector n = cross(b - a, c - a), d = c1 - c0;
  return std::abs(dot(n, d)) / std::sqrt(dot(n, n) * dot(d, d));
}

}  // namespace tetropolis::lanes
