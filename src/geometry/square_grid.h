// Places by squares of a grid: brings together what lies at one place, and keeps neighbours in
// space near each other in memory, which hashing would not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The x-y box of the points with finite coordinates.
inline Bounds2 box_of(const std::vector<std::array<double, 3>>& points) {
  Bounds2 box = Bounds2::nothing();
  for (const auto& p : points)
    if (std::isfinite(p[0]) && std::isfinite(p[1])) box.extend(Point2{p[0], p[1]});
  return box;
}

/// About `wanted` squares over a box, however large or empty that is: at most 3 wanted + 4.
class SquareGrid {
 public:
  SquareGrid(const Bounds2& box, std::size_t wanted) : west_(box.xmin), south_(box.ymin) {
    const double width = std::max(box.width(), 0.0), height = std::max(box.height(), 0.0);
    const double side = std::max(std::sqrt(width * height / static_cast<double>(wanted + 1)),
                                 std::max(width, height) / static_cast<double>(wanted + 1));
    if (!(side > 0) || !std::isfinite(side)) return;  // one square
    per_metre_ = 1 / side;
    columns_ = static_cast<std::size_t>(width / side) + 1;
    rows_ = static_cast<std::size_t>(height / side) + 1;
  }

  std::size_t size() const { return columns_ * rows_; }

  /// Number of the square of a point; the same for equal points. Points outside of the box, or not
  /// finite, get a square, too.
  std::size_t at(double x, double y) const { return row(y) * columns_ + column(x); }
  std::size_t at(const std::array<double, 3>& p) const { return at(p[0], p[1]); }

  /// Calls use(square) for the squares that `box` meets. Precondition: it is not empty.
  template <typename Use>
  void for_each_in(const Bounds2& box, const Use& use) const {
    for (std::size_t j = row(box.ymin); j <= row(box.ymax); ++j)
      use_row(j, box.xmin, box.xmax, use);
  }

  /// Calls use(square) for the squares within `margin` of the segment a-b, and for some more near
  /// its ends. The margin is wide enough for the rounding of coordinates: 1 mm, say.
  template <typename Use>
  void for_each_along(Point2 a, Point2 b, double margin, const Use& use) const {
    if (a.y > b.y) std::swap(a, b);
    const std::size_t last = row(b.y + margin);
    for (std::size_t j = row(a.y - margin); j <= last; ++j) {
      // Between these shares of its length the segment is within the margin of the row.
      const double share0 = share(static_cast<double>(j) / per_metre_ + south_ - margin, a, b, 0);
      const double share1 =
          share(static_cast<double>(j + 1) / per_metre_ + south_ + margin, a, b, 1);
      const double x0 = a.x + share0 * (b.x - a.x), x1 = a.x + share1 * (b.x - a.x);
      use_row(j, std::min(x0, x1) - margin, std::max(x0, x1) + margin, use);
    }
  }

 private:
  template <typename Use>
  void use_row(std::size_t j, double xmin, double xmax, const Use& use) const {
    for (std::size_t i = column(xmin); i <= column(xmax); ++i) use(j * columns_ + i);
  }

  /// Where the segment, which does not lead down, has the ordinate y; `without` if it is level.
  static double share(double y, Point2 a, Point2 b, double without) {
    const double s = (y - a.y) / (b.y - a.y);
    return std::isfinite(s) ? std::clamp(s, 0.0, 1.0) : without;
  }

  std::size_t column(double x) const { return index(x - west_, columns_); }
  std::size_t row(double y) const { return index(y - south_, rows_); }
  std::size_t index(double offset, std::size_t count) const {
    const double i = offset * per_metre_;
    if (!(i > 0)) return 0;
    return i < static_cast<double>(count) ? static_cast<std::size_t>(i) : count - 1;
  }

  double west_;
  double south_;
  double per_metre_ = 0;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
};

}  // namespace tetropolis
