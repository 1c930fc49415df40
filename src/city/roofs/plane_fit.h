// The plane of least squares through points. Private to src/city.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The steepest roof: 70 degrees.
inline constexpr double kMaxRoofSlope = 2.747;

inline double slope_of(const RoofPlane& plane) { return std::hypot(plane.slope_x, plane.slope_y); }

/// From the plane to the point, vertically.
inline double height_above(const RoofPlane& plane, const Point3& p) {
  return p[2] - plane(Point2{p[0], p[1]});
}

/// Whether a footprint's points fit one flat roof better, by more than 5 % of the root mean square:
/// sums of squares of their vertical distances from their roofs, and from the flat one.
inline bool is_misfit(double squares, double flat_squares) {
  return squares > 1.05 * 1.05 * flat_squares;
}

/// Moments of points about a place near them; those about the same place can be added.
class PlaneFit {
 public:
  explicit PlaneFit(Point2 about) : about_(about) {}

  void add(const Point3& p) {
    const double x = p[0] - about_.x, y = p[1] - about_.y, z = p[2];
    n_ += 1;
    x_ += x;
    y_ += y;
    z_ += z;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    xz_ += x * z;
    yz_ += y * z;
    zz_ += z * z;
  }
  PlaneFit& operator+=(const PlaneFit& other) {
    n_ += other.n_;
    x_ += other.x_;
    y_ += other.y_;
    z_ += other.z_;
    xx_ += other.xx_;
    xy_ += other.xy_;
    yy_ += other.yy_;
    xz_ += other.xz_;
    yz_ += other.yz_;
    zz_ += other.zz_;
    return *this;
  }

  double count() const { return n_; }

  /// The plane of least vertical squares; flat at the mean for points near to a line. Precondition:
  /// at least one point.
  RoofPlane plane() const {
    constexpr double kLine = 1e-3;
    return plane_unless_line(kLine).value_or(
        RoofPlane{{about_.x + x_ / n_, about_.y + y_ / n_}, z_ / n_, 0, 0});
  }

  /// Nothing for points so near to a line, seen from above, that the determinant of their
  /// covariance is at most `line` times the square of its trace.
  std::optional<RoofPlane> plane_unless_line(double line) const {
    const double mx = x_ / n_, my = y_ / n_, mz = z_ / n_;
    const double cxx = xx_ / n_ - mx * mx, cxy = xy_ / n_ - mx * my, cyy = yy_ / n_ - my * my;
    const double cxz = xz_ / n_ - mx * mz, cyz = yz_ / n_ - my * mz;
    const double det = cxx * cyy - cxy * cxy, trace = cxx + cyy;
    if (!(det > line * trace * trace)) return std::nullopt;
    return RoofPlane{{about_.x + mx, about_.y + my},
                     mz,
                     (cxz * cyy - cyz * cxy) / det,
                     (cyz * cxx - cxz * cxy) / det};
  }

  /// Of the vertical distances to plane().
  double sum_of_squares() const {
    const RoofPlane p = plane();
    const double mx = x_ / n_, my = y_ / n_, mz = z_ / n_;
    return std::max(0.0, (zz_ - n_ * mz * mz) - p.slope_x * (xz_ - n_ * mx * mz) -
                             p.slope_y * (yz_ - n_ * my * mz));
  }

 private:
  Point2 about_;
  double n_ = 0, x_ = 0, y_ = 0, z_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xz_ = 0, yz_ = 0, zz_ = 0;
};

}  // namespace tetropolis
