// Loops over tets and faces wherever their corners are, compiled for vectors: results are those of
// tet_cosines(), to the bit, and of the formulas of face_shape().
#pragma once

#include <array>
#include <cstddef>

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

/// Of tets, as TetCosines has it.
struct TetFigures {
  using Row = std::array<double, kTetBatch>;
  Row greatest, least, aspect, volume;
};

void measure_tets(const PointRows<4>& corners, TetFigures& figures);

/// Of faces: three corners and the centres of the cells on both sides. Sets `is_worse` to 0
/// where the squared cosine of non-orthogonality is above `straight2` and the squared skewness
/// below `skewness2`, and to more elsewhere.
void find_worse_faces(const PointRows<5>& faces, double straight2, double skewness2,
                      std::array<double, kTetBatch>& is_worse);

}  // namespace tetropolis
