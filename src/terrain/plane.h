// Planes of least squares. Private to src/terrain.
#pragma once

#include <cstdint>

namespace tetropolis {

/// A height over the cells (i, j) of a grid: rise_x * i + rise_y * j + height.
struct Plane {
  double rise_x = 0;  ///< Metres per cell, as is rise_y.
  double rise_y = 0;
  double height = 0;  ///< At cell (0, 0), metres.

  double at(std::int32_t i, std::int32_t j) const { return rise_x * i + rise_y * j + height; }
};

/// Sums for the plane of least squares through points (x, y, z).
class CellPlaneFit {
 public:
  void add(double x, double y, double z) {
    n_ += 1, x_ += x, y_ += y, z_ += z;
    xx_ += x * x, xy_ += x * y, yy_ += y * y, xz_ += x * z, yz_ += y * z;
  }
  /// False, and nothing is changed, where there are too few points or they lie on one line.
  bool solve(Plane& plane) const {
    if (n_ < 3) return false;
    const double xx = xx_ - x_ * x_ / n_, xy = xy_ - x_ * y_ / n_, yy = yy_ - y_ * y_ / n_;
    const double xz = xz_ - x_ * z_ / n_, yz = yz_ - y_ * z_ / n_;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-9 * xx * yy)) return false;
    plane.rise_x = (xz * yy - yz * xy) / determinant;
    plane.rise_y = (yz * xx - xz * xy) / determinant;
    plane.height = (z_ - plane.rise_x * x_ - plane.rise_y * y_) / n_;
    return true;
  }

 private:
  double n_ = 0, x_ = 0, y_ = 0, z_ = 0;
  double xx_ = 0, xy_ = 0, yy_ = 0, xz_ = 0, yz_ = 0;
};

}  // namespace tetropolis
