// What surrounds a column of the front, point by point in rows: for loops that become vectors.
#pragma once

#include <cstddef>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// In plan.
struct StarSizes {
  double altitude;  ///< The least of any triangle.
  double longest2;  ///< Of edges at the column, squared.
};

/// The worst of all cells and of the faces below and between them.
struct RiseFigures {
  double least;     ///< 1 - cosine of the least dihedral angle; 0 if a cell is inverted.
  double greatest;  ///< 1 + cosine of the greatest.
  double straight;  ///< Cosine of the greatest non-orthogonality.
};

class StarRows {
 public:
  /// Forgets all and makes room for `count` > 0 triangles.
  void start(std::size_t count);
  /// The nth triangle is from the column to `a` and `b`, over a cell with this centre. All are to
  /// be set, in this order.
  void set(std::size_t n, const Point3& a, const Point3& b, const Point3& below) {
    const std::size_t end = n + 1 < count_ ? n + 1 : lanes_;
    for (std::size_t k = n; k < end; ++k) {
      double* at = rows_.data() + k;
      for (const Point3* const point : {&a, &b, &below})
        for (const double x : *point) {
          *at = x;
          at += stride_;
        }
    }
  }

  StarSizes sizes_around(const Point3& column);
  /// If the column rises by cells over all triangles. `is_closed`: the last triangle is beside the
  /// first.
  RiseFigures measure_rise(const Point3& column, double to, bool is_closed);

 private:
  double* row(std::size_t i) { return rows_.data() + i * stride_; }

  std::size_t count_ = 0, lanes_ = 0, stride_ = 0;
  std::vector<double> rows_;
};

}  // namespace tetropolis
