#include "tet_kernels.h"

#include <cmath>

#include "core/infinity.h"
#include "core/wide.h"
#include "tet_lanes.h"

namespace tetropolis {

namespace {

using lanes::Vector;

TETROPOLIS_INLINE Vector point(const double* rows, std::size_t i, std::size_t k) {
  return {rows[3 * i * kRowStride + k], rows[(3 * i + 1) * kRowStride + k],
          rows[(3 * i + 2) * kRowStride + k]};
}

TETROPOLIS_WIDE void measure_tets(std::size_t count, const double* __restrict p,
                                  double* __restrict greatest, double* __restrict least,
                                  double* __restrict aspect, double* __restrict volume) {
  for (std::size_t k = 0; k < count; ++k) {
    const Vector p0 = point(p, 0, k), p1 = point(p, 1, k), p2 = point(p, 2, k);
    const Vector p3 = point(p, 3, k);
    const lanes::Tet tet = lanes::measure_tet(p0, p1, p2, p3);
    greatest[k] = tet.greatest;
    least[k] = tet.least;
    const Vector e01 = p1 - p0, e02 = p2 - p0, e03 = p3 - p0;
    const Vector e12 = p2 - p1, e13 = p3 - p1, e23 = p3 - p2;
    const double longest2 =
        lanes::greater(lanes::greater(lanes::greater(dot(e01, e01), dot(e02, e02)),
                                      lanes::greater(dot(e03, e03), dot(e12, e12))),
                       lanes::greater(dot(e13, e13), dot(e23, e23)));
    volume[k] = tet.six_volumes / 6;
    aspect[k] = tet.six_volumes != 0
                    ? std::sqrt(longest2 / 24) * tet.twice_area / std::abs(tet.six_volumes)
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
    const double q2 =
        lanes::greater(lanes::greater(0.04 * dd * ss, qa * qa), lanes::greater(qb * qb, qc * qc));
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
