#include "star_rows.h"

#include <algorithm>
#include <cmath>

#include "core/wide.h"
#include "volume/quality/tet_lanes.h"

namespace tetropolis {

namespace {

using lanes::Vector;

/// The rows, of coordinates the first of three; set() fills the first nine.
enum Row : std::size_t {
  kA = 0,
  kB = 3,
  kBelow = 6,
  kCentre = 9,  // of the cell before each triangle
  kLeast = 12,
  kGreatest,
  kBelowFaces,
  kBetween,
  kRows
};

TETROPOLIS_WIDE void measure_sizes(std::size_t count, std::size_t stride,
                                   const double* __restrict rows, double x, double y,
                                   double* __restrict altitude, double* __restrict longest2) {
  for (std::size_t k = 0; k < count; ++k) {
    const double px = rows[kA * stride + k], py = rows[(kA + 1) * stride + k];
    const double qx = rows[kB * stride + k], qy = rows[(kB + 1) * stride + k];
    const double op = (px - x) * (px - x) + (py - y) * (py - y);
    const double oq = (qx - x) * (qx - x) + (qy - y) * (qy - y);
    const double pq = (qx - px) * (qx - px) + (qy - py) * (qy - py);
    const double area = (px - x) * (qy - y) - (py - y) * (qx - x);
    longest2[k] = lanes::greater(op, oq);
    altitude[k] = area / std::sqrt(lanes::greater(longest2[k], pq));
  }
}

/// Cells and the faces below them. `centre`: where their centres go.
TETROPOLIS_WIDE void measure_cells(std::size_t count, std::size_t stride,
                                   const double* __restrict rows, Vector p, double to,
                                   double* __restrict centre, double* __restrict least,
                                   double* __restrict greatest, double* __restrict straight) {
  const Vector up{p.x, p.y, to};
  for (std::size_t k = 0; k < count; ++k) {
    const Vector a = lanes::point(rows + kA * stride, stride, k),
                 b = lanes::point(rows + kB * stride, stride, k);
    const lanes::Tet tet = lanes::measure_tet(p, a, b, up);
    const Vector c = lanes::centre_of(p, a, b, up);
    centre[k] = c.x;
    centre[stride + k] = c.y;
    centre[2 * stride + k] = c.z;
    least[k] = tet.six_volumes / 6 > 0 ? 1 - tet.greatest : 0;
    greatest[k] = 1 + tet.least;
    straight[k] = lanes::straightness(p, a, b, lanes::point(rows + kBelow * stride, stride, k), c);
  }
}

/// The faces between cells and those before them, whose centres are one entry before.
TETROPOLIS_WIDE void measure_between(std::size_t count, std::size_t stride,
                                     const double* __restrict rows, Vector p, double to,
                                     double* __restrict straight) {
  const Vector up{p.x, p.y, to};
  for (std::size_t k = 0; k < count; ++k)
    straight[k] = lanes::straightness(p, lanes::point(rows + kA * stride, stride, k), up,
                                      lanes::point(rows + kCentre * stride, stride, k),
                                      lanes::point(rows + kCentre * stride, stride, k + 1));
}

}  // namespace

void StarRows::start(std::size_t count) {
  count_ = count;
  lanes_ = lanes::filled_up(count);
  if (lanes_ + 1 > stride_) {
    stride_ = lanes_ + 1;
    rows_.resize(kRows * stride_);
  }
}

StarSizes StarRows::sizes_around(const Point3& column) {
  double *const altitude = row(kLeast), *const longest2 = row(kGreatest);
  measure_sizes(lanes_, stride_, rows_.data(), column[0], column[1], altitude, longest2);
  return {*std::min_element(altitude, altitude + count_),
          *std::max_element(longest2, longest2 + count_)};
}

RiseFigures StarRows::measure_rise(const Point3& column, double to, bool is_closed) {
  const Vector p{column[0], column[1], column[2]};
  double *const least = row(kLeast), *const greatest = row(kGreatest);
  double *const below = row(kBelowFaces), *const between = row(kBetween);
  measure_cells(lanes_, stride_, rows_.data(), p, to, row(kCentre) + 1, least, greatest, below);
  for (std::size_t c = 0; c < 3; ++c) row(kCentre + c)[0] = row(kCentre + c)[count_];
  measure_between(lanes_, stride_, rows_.data(), p, to, between);
  if (!is_closed) between[0] = 1;
  RiseFigures worst{2, 2, 1};
  for (std::size_t k = 0; k < count_; ++k) {
    worst.least = std::min(worst.least, least[k]);
    worst.greatest = std::min(worst.greatest, greatest[k]);
    worst.straight = std::min({worst.straight, below[k], between[k]});
  }
  return worst;
}

}  // namespace tetropolis
