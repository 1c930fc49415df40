// Loops over tets and faces of the upper part, compiled for vectors: results are those of
// tet_cosines(), to the bit, and of the formulas of face_shape().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// So many at most.
inline constexpr std::size_t kTetBatch = 256;

/// From row to row: were it a power of two, all rows would share few sets of the cache.
inline constexpr std::size_t kRowStride = kTetBatch + 8;

/// Coordinates x, y, z of points, point after point, each a row.
template <std::size_t kPoints>
class PointRows {
 public:
  std::size_t size() const { return size_; }
  bool is_full() const { return size_ == kTetBatch; }
  void clear() { size_ = 0; }
  void add(const std::array<const Point3*, kPoints>& points) {
    for (std::size_t i = 0; i < kPoints; ++i)
      for (std::size_t c = 0; c < 3; ++c) row(i, c)[size_] = (*points[i])[c];
    ++size_;
  }
  std::array<Point3, kPoints> operator[](std::size_t k) const {
    std::array<Point3, kPoints> points;
    for (std::size_t i = 0; i < kPoints; ++i)
      for (std::size_t c = 0; c < 3; ++c) points[i][c] = rows_[(3 * i + c) * kRowStride + k];
    return points;
  }
  const double* data() const { return rows_.data(); }

 private:
  double* row(std::size_t point, std::size_t c) {
    return rows_.data() + (3 * point + c) * kRowStride;
  }
  std::array<double, 3 * kPoints * kRowStride> rows_;
  std::size_t size_ = 0;
};

/// Of tets: what TetCosines has, and their centres.
struct TetFigures {
  using Row = std::array<double, kRowStride>;
  Row greatest, least, aspect, volume;
  std::array<Row, 3> centres;
  Point3 centre(std::size_t k) const { return {centres[0][k], centres[1][k], centres[2][k]}; }
};

/// Faces are of interest where the squared cosine of non-orthogonality is not above `straight2`, or
/// the squared skewness not below `skewness2`.
struct FaceLimits {
  double straight2 = std::numeric_limits<double>::max(), skewness2 = 0;
};

/// A fan that goes up and is closed: points around its column, counter-clockwise.
class FanRows {
 public:
  /// More do not fit.
  static constexpr std::size_t kMost = 24;

  /// Precondition: 3 <= cells <= kMost.
  void start(std::size_t cells) { cells_ = cells; }
  std::size_t cells() const { return cells_; }
  /// Cell n is over this point and the next one.
  void set_point(std::size_t n, const Point3& p) {
    for (std::size_t c = 0; c < 3; ++c) at(kRing + c, n) = p[c];
  }
  /// The centre of the cell below; none: there is no face.
  void set_below(std::size_t n, const Point3* centre) {
    for (std::size_t c = 0; c < 3; ++c) at(kBelow + c, n) = centre == nullptr ? 0 : (*centre)[c];
    at(kHasBelow, n) = centre == nullptr ? 0 : 1;
  }
  /// Writes the figures of its cells, from `begin` on; begin + kMost < kRowStride. Returns whether
  /// a face below or between them is of interest.
  bool measure(const Point3& node, double up, const FaceLimits& limits, TetFigures& figures,
               std::size_t begin);

 private:
  static constexpr std::size_t kStride = kMost + 8;
  enum Row : std::size_t { kRing = 0, kBelow = 3, kHasBelow = 6, kRows = 7 };
  double& at(std::size_t row, std::size_t n) { return rows_[row * kStride + n]; }

  std::size_t cells_ = 0;
  std::array<double, kRows * kStride> rows_{};
};

/// Writes figures from 0 on.
void measure_tets(const PointRows<4>& corners, TetFigures& figures);

/// Of faces: three corners and the centres of the cells on both sides. Sets `is_worse` to 0 where
/// they are of no interest, and to more elsewhere.
void find_worse_faces(const PointRows<5>& faces, const FaceLimits& limits,
                      std::array<double, kTetBatch>& is_worse);

}  // namespace tetropolis
