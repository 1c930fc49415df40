// Places by squares of a grid: brings together what lies at one place, and keeps neighbours in
// space near each other in memory, which hashing would not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace tetropolis {

/// About `wanted` squares over the x-y box of the points with finite coordinates.
class Squares {
 public:
  Squares(const std::vector<std::array<double, 3>>& points, std::size_t wanted) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    std::array<double, 2> low{inf, inf}, high{-inf, -inf};
    for (const auto& p : points)
      for (std::size_t d = 0; d < 2; ++d)
        if (std::isfinite(p[d])) {
          low[d] = std::min(low[d], p[d]);
          high[d] = std::max(high[d], p[d]);
        }
    low_ = low;
    const double width = std::max(high[0] - low[0], 0.0), height = std::max(high[1] - low[1], 0.0);
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
  std::size_t at(const std::array<double, 3>& p) const {
    return index(p[1] - low_[1], rows_) * columns_ + index(p[0] - low_[0], columns_);
  }

 private:
  std::size_t index(double offset, std::size_t count) const {
    const double i = offset * per_metre_;
    if (!(i > 0)) return 0;
    return i < static_cast<double>(count) ? static_cast<std::size_t>(i) : count - 1;
  }

  std::array<double, 2> low_{};
  double per_metre_ = 0;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
};

}  // namespace tetropolis
