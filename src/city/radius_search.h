// The points of one building, and those around each of them. Private to src/city.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/city/extract.h"
#include "tetropolis/core/ragged_array.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/point_cloud.h"

#include "core/ragged_builder.h"

namespace tetropolis {

/// Mean and products of differences, of points relative to one of them.
struct Moments {
  double n = 0, x = 0, y = 0, z = 0;
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  void add(double dx, double dy, double dz) {
    n += 1;
    x += dx, y += dy, z += dz;
    xx += dx * dx, yy += dy * dy, zz += dz * dz;
    xy += dx * dy, xz += dx * dz, yz += dy * dz;
  }

  /// Least eigenvalue of the covariance, by the trigonometric formula (Smith, "Eigenvalues of a
  /// symmetric 3 x 3 matrix", Comm. ACM 4, 1961).
  double least_variance() const {
    const double a = xx / n - x * x / (n * n), b = yy / n - y * y / (n * n),
                 c = zz / n - z * z / (n * n);
    const double d = xy / n - x * y / (n * n), e = xz / n - x * z / (n * n),
                 f = yz / n - y * z / (n * n);
    const double mean = (a + b + c) / 3;
    const double u = a - mean, v = b - mean, w = c - mean;
    const double spread = std::sqrt((u * u + v * v + w * w + 2 * (d * d + e * e + f * f)) / 6);
    if (!(spread > 0)) return mean;
    const double determinant = u * (v * w - f * f) - d * (d * w - f * e) + e * (d * f - v * e);
    const double cosine = std::clamp(determinant / (2 * spread * spread * spread), -1.0, 1.0);
    return mean + 2 * spread * std::cos(std::acos(cosine) / 3 + 2 * std::numbers::pi / 3);
  }
};

/// The points of one building in cells as wide as the radius: the one asked for, or less where, at
/// the mean density of the box around the points, kEnoughPoints lie within a smaller one. Where
/// points crowd (on facades that a vehicle has scanned), the radius is too large, and all disks
/// together would have the square of them: of the points of a cell every so-manieth, kMostInCell in
/// all, is seen by the others. That is far above the ten that a cell has on average.
class RadiusSearch {
 public:
  static constexpr double kEnoughPoints = 30;
  static constexpr std::size_t kMostInCell = 256;

  /// Precondition: at least one point; radius > 0, metres.
  RadiusSearch(std::vector<PointIndex> points, const PointCloud& cloud, double radius)
      : points_(std::move(points)), cloud_(cloud) {
    const auto [west, east] = range(cloud.x);
    const auto [south, north] = range(cloud.y);
    x0_ = west;
    y0_ = south;
    const double area = std::max((east - west) * (north - south), 1.0);
    const double spacing = std::sqrt(area / static_cast<double>(points_.size()));
    constexpr double kMostCells = 1e6;
    radius_ = std::max(std::min(radius, spacing * std::sqrt(kEnoughPoints / std::numbers::pi)),
                       std::sqrt(area / kMostCells));
    columns_ = static_cast<std::int64_t>((east - west) / radius_) + 1;
    rows_ = static_cast<std::int64_t>((north - south) / radius_) + 1;
    cells_ = ragged_from_pairs<std::size_t>(static_cast<std::size_t>(columns_ * rows_),
                                            [&](const auto& use) {
                                              for (std::size_t k = 0; k < points_.size(); ++k)
                                                use(cell_of(points_[k]), k);
                                            });
    thin();
  }

  std::size_t size() const { return points_.size(); }
  double z(std::size_t k) const { return cloud_.z[points_[k]]; }

  /// Calls visit(number) for the points within the radius of number `k` seen from above, itself
  /// among them: at most nine cells of kMostInCell, and itself.
  template <typename Visit>
  void in_radius(std::size_t k, const Visit& visit) const {
    const PointIndex p = points_[k];
    const std::int64_t ci = column(p), cj = row(p);
    for (std::int64_t j = std::max<std::int64_t>(cj - 1, 0); j <= std::min(cj + 1, rows_ - 1); ++j)
      for (std::int64_t i = std::max<std::int64_t>(ci - 1, 0); i <= std::min(ci + 1, columns_ - 1);
           ++i) {
        for (const std::size_t other : cells_[row_major(i, j, columns_)]) {
          const PointIndex q = points_[other];
          const double dx = cloud_.x[q] - cloud_.x[p];
          const double dy = cloud_.y[q] - cloud_.y[p];
          if (dx * dx + dy * dy <= radius_ * radius_) visit(other);
        }
      }
    if (unseen_[k] != 0) visit(k);
  }

  /// The same for those that are no further in height either.
  template <typename Visit>
  void near(std::size_t k, const Visit& visit) const {
    in_radius(k, [&](std::size_t other) {
      if (std::abs(z(other) - z(k)) <= radius_) visit(other);
    });
  }

  /// Whether the points near number `k` are one surface.
  bool on_surface(std::size_t k, double thickness) const {
    constexpr double kLeastNeighbours = 5;  // that make a plane credible
    Moments moments;
    const PointIndex p = points_[k];
    near(k, [&](std::size_t other) {
      const PointIndex q = points_[other];
      moments.add(cloud_.x[q] - cloud_.x[p], cloud_.y[q] - cloud_.y[p], cloud_.z[q] - cloud_.z[p]);
    });
    const double most = thickness * radius_;
    return moments.n >= kLeastNeighbours && moments.least_variance() <= most * most;
  }

 private:
  /// Leaves at most kMostInCell in each cell.
  void thin() {
    unseen_.assign(points_.size(), 0);
    RaggedArray<std::size_t> thinned;
    std::vector<std::size_t> some;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const std::span<const std::size_t> all = std::as_const(cells_)[c];
      const std::size_t left = std::min(all.size(), kMostInCell);
      if (left < all.size())
        for (const std::size_t k : all) unseen_[k] = 1;
      some.clear();
      for (std::size_t n = 0; n < left; ++n) some.push_back(all[n * all.size() / left]);
      for (const std::size_t k : some) unseen_[k] = 0;
      thinned.push_back(some);
    }
    cells_ = std::move(thinned);
  }

  std::pair<double, double> range(std::span<const PointCoordinate> values) const {
    double low = values[points_[0]], high = low;
    for (const PointIndex p : points_) {
      low = std::min<double>(low, values[p]);
      high = std::max<double>(high, values[p]);
    }
    return {low, high};
  }
  std::int64_t column(PointIndex p) const {
    return static_cast<std::int64_t>((cloud_.x[p] - x0_) / radius_);
  }
  std::int64_t row(PointIndex p) const {
    return static_cast<std::int64_t>((cloud_.y[p] - y0_) / radius_);
  }
  std::size_t cell_of(PointIndex p) const { return row_major(column(p), row(p), columns_); }

  std::vector<PointIndex> points_;
  const PointCloud& cloud_;
  double radius_ = 1;
  double x0_ = 0;
  double y0_ = 0;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  RaggedArray<std::size_t> cells_;    ///< The numbers of points that others see, by cell.
  std::vector<std::uint8_t> unseen_;  ///< Per point: whether others do not see it.
};

}  // namespace tetropolis
