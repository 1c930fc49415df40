#include "tet_kernels.h"

#include <cmath>

#include "core/infinity.h"
#include "core/wide.h"

namespace tetropolis {

namespace {

TETROPOLIS_INLINE double greater(double a, double b) { return a < b ? b : a; }
TETROPOLIS_INLINE double lesser(double a, double b) { return b < a ? b : a; }

// Not arrays: loops over these would not become vectors.
struct Vector {
  double x, y, z;
};
TETROPOLIS_INLINE Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
TETROPOLIS_INLINE Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
TETROPOLIS_INLINE double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
TETROPOLIS_INLINE double per(double length) { return length > 0 ? 1 / length : 0; }
TETROPOLIS_INLINE Vector point(const double* rows, std::size_t i, std::size_t k) {
  return {rows[3 * i * kTetBatch + k], rows[(3 * i + 1) * kTetBatch + k],
          rows[(3 * i + 2) * kTetBatch + k]};
}

TETROPOLIS_WIDE void measure_tets(std::size_t count, const double* __restrict p,
                                  double* __restrict greatest, double* __restrict least,
                                  double* __restrict aspect, double* __restrict volume) {
  for (std::size_t k = 0; k < count; ++k) {
    const Vector p0 = point(p, 0, k), p1 = point(p, 1, k), p2 = point(p, 2, k);
    const Vector p3 = point(p, 3, k);
    const Vector e01 = p1 - p0, e02 = p2 - p0, e03 = p3 - p0;
    const Vector e12 = p2 - p1, e13 = p3 - p1, e23 = p3 - p2;
    const Vector n0 = cross(e12, e13), n1 = cross(e03, e02);
    const Vector n2 = cross(e01, e03), n3 = cross(e02, e01);
    const double l0 = std::sqrt(dot(n0, n0)), l1 = std::sqrt(dot(n1, n1));
    const double l2 = std::sqrt(dot(n2, n2)), l3 = std::sqrt(dot(n3, n3));
    const double q0 = per(l0), q1 = per(l1), q2 = per(l2), q3 = per(l3);
    const double c01 = -dot(n0, n1) * (q0 * q1), c02 = -dot(n0, n2) * (q0 * q2);
    const double c03 = -dot(n0, n3) * (q0 * q3), c12 = -dot(n1, n2) * (q1 * q2);
    const double c13 = -dot(n1, n3) * (q1 * q3), c23 = -dot(n2, n3) * (q2 * q3);
    greatest[k] = greater(greater(greater(c01, c02), greater(c03, c12)), greater(c13, c23));
    least[k] = lesser(lesser(lesser(c01, c02), lesser(c03, c12)), lesser(c13, c23));
    const double longest2 = greater(
        greater(greater(dot(e01, e01), dot(e02, e02)), greater(dot(e03, e03), dot(e12, e12))),
        greater(dot(e13, e13), dot(e23, e23)));
    const double six_volumes = -dot(n3, e03);
    volume[k] = six_volumes / 6;
    aspect[k] = six_volumes != 0
                    ? std::sqrt(longest2 / 24) * (l0 + l1 + l2 + l3) / std::abs(six_volumes)
                    : kInfinity;
  }
}

TETROPOLIS_WIDE void find_worse_faces(std::size_t count, const double* __restrict p,
                                      double straight2, double skewness2,
                                      double* __restrict is_worse) {
  for (std::size_t k = 0; k < count; ++k) {
    const Vector a = point(p, 0, k), b = point(p, 1, k), c = point(p, 2, k);
    const Vector c0 = point(p, 3, k), c1 = point(p, 4, k);
    const Vector n = cross(b - a, c - a), d = c1 - c0;
    const double n_d = dot(n, d), dd = dot(d, d);
    const Vector centre{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3};
    const Vector to = centre - c0;
    const double share = dot(n, to) / n_d;
    const Vector skew{to.x - share * d.x, to.y - share * d.y, to.z - share * d.z};
    const double ss = dot(skew, skew);
    const double qa = dot(skew, a - centre), qb = dot(skew, b - centre), qc = dot(skew, c - centre);
    // Of skewness, the squared denominator.
    const double q2 = greater(greater(0.04 * dd * ss, qa * qa), greater(qb * qb, qc * qc));
    const double straight = n_d * n_d > straight2 * (dot(n, n) * dd) ? 0 : 1;
    const double skewed = ss * ss < skewness2 * q2 ? 0 : 1;
    is_worse[k] = straight + skewed;
  }
}

}  // namespace

void measure_tets(const PointRows<4>& corners, TetFigures& figures) {
  measure_tets(corners.size(), corners.data(), figures.greatest.data(), figures.least.data(),
               figures.aspect.data(), figures.volume.data());
}

void find_worse_faces(const PointRows<5>& faces, double straight2, double skewness2,
                      std::array<double, kTetBatch>& is_worse) {
  find_worse_faces(faces.size(), faces.data(), straight2, skewness2, is_worse.data());
}

}  // namespace tetropolis
