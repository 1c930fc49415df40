#include "tet_kernels.h"

#include <algorithm>
#include <cmath>

#include "core/infinity.h"
#include "core/wide.h"
#include "tet_lanes.h"

namespace tetropolis {

namespace {

using lanes::dot;
using lanes::greater;
using lanes::Vector;

TETROPOLIS_INLINE Vector corner(const double* rows, std::size_t i, std::size_t k) {
  return lanes::point(rows + 3 * i * kRowStride, kRowStride, k);
}

TETROPOLIS_INLINE double aspect_of(const lanes::Tet& tet, Vector p0, Vector p1, Vector p2,
                                   Vector p3) {
  const Vector e01 = p1 - p0, e02 = p2 - p0, e03 = p3 - p0;
  const Vector e12 = p2 - p1, e13 = p3 - p1, e23 = p3 - p2;
  const double longest2 =
      greater(greater(greater(dot(e01, e01), dot(e02, e02)), greater(dot(e03, e03), dot(e12, e12))),
              greater(dot(e13, e13), dot(e23, e23)));
  return tet.six_volumes != 0
             ? std::sqrt(longest2 / 24) * tet.twice_area / std::abs(tet.six_volumes)
             : kInfinity;
}

/// 0 if the face a - b - c is of no interest.
TETROPOLIS_INLINE double worse(Vector a, Vector b, Vector c, Vector c0, Vector c1, double straight2,
                               double skewness2) {
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
  return straight + skewed;
}

TETROPOLIS_WIDE void measure_tets(std::size_t count, const double* __restrict p,
                                  double* __restrict greatest, double* __restrict least,
                                  double* __restrict aspect, double* __restrict volume,
                                  double* __restrict x, double* __restrict y,
                                  double* __restrict z) {
  for (std::size_t k = 0; k < count; ++k) {
    const Vector p0 = corner(p, 0, k), p1 = corner(p, 1, k), p2 = corner(p, 2, k);
    const Vector p3 = corner(p, 3, k);
    const lanes::Tet tet = lanes::measure_tet(p0, p1, p2, p3);
    const Vector centre = lanes::centre_of(p0, p1, p2, p3);
    greatest[k] = tet.greatest;
    least[k] = tet.least;
    aspect[k] = aspect_of(tet, p0, p1, p2, p3);
    volume[k] = tet.six_volumes / 6;
    x[k] = centre.x;
    y[k] = centre.y;
    z[k] = centre.z;
  }
}

TETROPOLIS_WIDE void find_worse_faces(std::size_t count, const double* __restrict p,
                                      double straight2, double skewness2,
                                      double* __restrict is_worse) {
  for (std::size_t k = 0; k < count; ++k)
    is_worse[k] = worse(corner(p, 0, k), corner(p, 1, k), corner(p, 2, k), corner(p, 3, k),
                        corner(p, 4, k), straight2, skewness2);
}

/// `below` is followed by a row that tells where it is valid.
TETROPOLIS_WIDE void measure_fan(std::size_t count, std::size_t stride,
                                 const double* __restrict ring, const double* __restrict below,
                                 Vector node, double up_z, double straight2, double skewness2,
                                 double* __restrict greatest, double* __restrict least,
                                 double* __restrict aspect, double* __restrict volume,
                                 double* __restrict centres, double* __restrict is_worse) {
  const Vector up{node.x, node.y, up_z};
  for (std::size_t k = 0; k < count; ++k) {
    const Vector a = lanes::point(ring, stride, k), b = lanes::point(ring, stride, k + 1);
    const lanes::Tet tet = lanes::measure_tet(node, a, b, up);
    const Vector c = lanes::centre_of(node, a, b, up);
    greatest[k] = tet.greatest;
    least[k] = tet.least;
    aspect[k] = aspect_of(tet, node, a, b, up);
    volume[k] = tet.six_volumes / 6;
    centres[k] = c.x;
    centres[kRowStride + k] = c.y;
    centres[2 * kRowStride + k] = c.z;
    is_worse[k] = worse(node, b, a, c, lanes::point(below, stride, k), straight2, skewness2) *
                  below[3 * stride + k];
  }
}

/// The faces between cells and the next ones.
TETROPOLIS_WIDE void find_worse_between(std::size_t count, std::size_t stride,
                                        const double* __restrict ring,
                                        const double* __restrict centres, Vector node, double up_z,
                                        double straight2, double skewness2,
                                        double* __restrict is_worse) {
  const Vector up{node.x, node.y, up_z};
  for (std::size_t k = 0; k < count; ++k)
    is_worse[k] +=
        worse(node, up, lanes::point(ring, stride, k + 1), lanes::point(centres, kRowStride, k),
              lanes::point(centres, kRowStride, k + 1), straight2, skewness2);
}

}  // namespace

bool FanRows::measure(const Point3& node, double up, const FaceLimits& limits, TetFigures& figures,
                      std::size_t begin) {
  // With the first cells again.
  const std::size_t count = lanes::filled_up(cells_);
  for (std::size_t row = 0; row < kRows; ++row)
    for (std::size_t k = cells_; k <= count; ++k) at(row, k) = at(row, k - cells_);
  const Vector p{node[0], node[1], node[2]};
  std::array<double, kStride> is_worse;
  double* const centres = figures.centres[0].data() + begin;
  measure_fan(count, kStride, &at(kRing, 0), &at(kBelow, 0), p, up, limits.straight2,
              limits.skewness2, figures.greatest.data() + begin, figures.least.data() + begin,
              figures.aspect.data() + begin, figures.volume.data() + begin, centres,
              is_worse.data());
  for (std::size_t c = 0; c < 3; ++c)
    centres[c * kRowStride + count] = centres[c * kRowStride + count - cells_];
  find_worse_between(count, kStride, &at(kRing, 0), centres, p, up, limits.straight2,
                     limits.skewness2, is_worse.data());
  double worse = 0;
  for (std::size_t k = 0; k < count; ++k) worse += is_worse[k];
  return worse > 0;
}

void measure_tets(const PointRows<4>& corners, TetFigures& figures) {
  measure_tets(corners.size(), corners.data(), figures.greatest.data(), figures.least.data(),
               figures.aspect.data(), figures.volume.data(), figures.centres[0].data(),
               figures.centres[1].data(), figures.centres[2].data());
}

void find_worse_faces(const PointRows<5>& faces, const FaceLimits& limits,
                      std::array<double, kTetBatch>& is_worse) {
  find_worse_faces(faces.size(), faces.data(), limits.straight2, limits.skewness2, is_worse.data());
}

}  // namespace tetropolis
