#include "tetropolis/city/crowns.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/core/parallel.h"

#include "city/point_lists.h"

namespace tetropolis {

namespace {

constexpr std::size_t kBuildingGrain = 4;
constexpr double kEnoughPoints = 30;    // in a disk
constexpr double kMostCells = 1e6;      // of one building
constexpr int kLeastNeighbours = 5;     // that make a plane credible
constexpr double kTreeHeight = 2.5;     // metres above a building's lowest point
constexpr double kTallerTree = 3;       // metres that a crown may be higher than those around
constexpr double kSurfaceShare = 0.5;   // of neighbours on surfaces, at most, in crowns
constexpr double kRemainder = 0.15;     // of a list that is too little to be a roof
constexpr double kOpenRemainder = 0.5;  // the same where much ground is seen inside
constexpr double kOpenGround = 0.2;     // share of points that is much

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

/// The points of one building in cells as wide as the radius.
class Disks {
 public:
  Disks(std::vector<PointIndex> points, const PointCloud& cloud, double radius)
      : points_(std::move(points)), cloud_(cloud) {
    const auto [west, east] = range(cloud.x);
    const auto [south, north] = range(cloud.y);
    x0_ = west;
    y0_ = south;
    const double area = std::max((east - west) * (north - south), 1.0);
    const double spacing = std::sqrt(area / static_cast<double>(points_.size()));
    radius_ = std::max(std::min(radius, spacing * std::sqrt(kEnoughPoints / std::numbers::pi)),
                       std::sqrt(area / kMostCells));
    columns_ = static_cast<std::int64_t>((east - west) / radius_) + 1;
    rows_ = static_cast<std::int64_t>((north - south) / radius_) + 1;
    offsets_.assign(static_cast<std::size_t>(columns_ * rows_ + 1), 0);
    for (const PointIndex p : points_) ++offsets_[cell_of(p) + 1];
    for (std::size_t c = 1; c < offsets_.size(); ++c) offsets_[c] += offsets_[c - 1];
    numbers_.resize(points_.size());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t k = 0; k < points_.size(); ++k) numbers_[next[cell_of(points_[k])]++] = k;
  }

  std::size_t size() const { return points_.size(); }
  double z(std::size_t k) const { return cloud_.z[points_[k]]; }

  /// Calls visit(number) for the points within the radius of number `k` seen from above, itself
  /// among them.
  template <typename Visit>
  void in_disk(std::size_t k, const Visit& visit) const {
    const PointIndex p = points_[k];
    const std::int64_t ci = column(p), cj = row(p);
    for (std::int64_t j = std::max<std::int64_t>(cj - 1, 0); j <= std::min(cj + 1, rows_ - 1); ++j)
      for (std::int64_t i = std::max<std::int64_t>(ci - 1, 0); i <= std::min(ci + 1, columns_ - 1);
           ++i) {
        const auto cell = static_cast<std::size_t>(j * columns_ + i);
        for (std::size_t n = offsets_[cell]; n < offsets_[cell + 1]; ++n) {
          const PointIndex q = points_[numbers_[n]];
          const double dx = cloud_.x[q] - cloud_.x[p];
          const double dy = cloud_.y[q] - cloud_.y[p];
          if (dx * dx + dy * dy <= radius_ * radius_) visit(numbers_[n]);
        }
      }
  }

  /// The same for those that are no further in height either.
  template <typename Visit>
  void near(std::size_t k, const Visit& visit) const {
    in_disk(k, [&](std::size_t other) {
      if (std::abs(z(other) - z(k)) <= radius_) visit(other);
    });
  }

  /// Whether the points near number `k` are one surface.
  bool on_surface(std::size_t k, double thickness) const {
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
  std::size_t cell_of(PointIndex p) const {
    return static_cast<std::size_t>(row(p) * columns_ + column(p));
  }

  std::vector<PointIndex> points_;
  const PointCloud& cloud_;
  double radius_ = 1;
  double x0_ = 0;
  double y0_ = 0;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  std::vector<std::size_t> offsets_;
  std::vector<std::size_t> numbers_;  // of points, cell by cell
};

/// Per point, the quantile `share` of the heights around it.
std::vector<double> levels(const Disks& disks, double share) {
  std::vector<double> result(disks.size());
  std::vector<double> heights;
  for (std::size_t k = 0; k < disks.size(); ++k) {
    heights.clear();
    disks.in_disk(k, [&](std::size_t other) { heights.push_back(disks.z(other)); });
    const auto rank = static_cast<std::size_t>(static_cast<double>(heights.size()) * share);
    const auto nth = heights.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(heights.begin(), nth, heights.end());
    result[k] = *nth;
  }
  return result;
}

/// The points of one building, and what is known of their surroundings.
struct Scene {
  std::span<const PointIndex> roof, below, around, beside;
};

/// How far each roof point is above the highest level around it; minus infinity where something
/// says that it belongs to a building.
std::vector<double> overhangs(const Scene& scene, const Disks& disks, const PointCloud& cloud,
                              const CrownOptions& options) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double treetops = kNone;
  for (const PointIndex p : scene.around) treetops = std::max<double>(treetops, cloud.z[p]);
  const std::vector<double> level = levels(disks, options.share);
  std::vector<std::uint8_t> surface(disks.size());
  for (std::size_t k = 0; k < disks.size(); ++k)
    surface[k] = disks.on_surface(k, options.thickness) ? 1 : 0;
  const std::size_t first_beside = scene.roof.size() + scene.below.size();
  std::vector<double> result(scene.roof.size(), kNone);
  for (std::size_t k = 0; k < result.size(); ++k) {
    if (disks.z(k) > treetops + kTallerTree) continue;
    double highest = level[k];
    int as_high = 0, on_roofs = 0;  // of points of roofs beside
    disks.in_disk(k, [&](std::size_t other) {
      highest = std::max(highest, level[other]);
      if (other < first_beside || disks.z(other) < disks.z(k) - options.height) return;
      ++as_high;
      on_roofs += surface[other];
    });
    if (on_roofs > kSurfaceShare * as_high) continue;
    int near = 0, on_surfaces = 0;
    disks.near(k, [&](std::size_t other) {
      ++near;
      on_surfaces += surface[other];
    });
    if (on_surfaces <= kSurfaceShare * near) result[k] = disks.z(k) - highest;
  }
  return result;
}

std::vector<PointIndex> without_crowns(const Scene& scene, const PointCloud& cloud,
                                       const CrownOptions& options) {
  const std::span<const PointIndex> roof = scene.roof, below = scene.below;
  std::vector<PointIndex> all(roof.begin(), roof.end());
  all.insert(all.end(), below.begin(), below.end());
  all.insert(all.end(), scene.beside.begin(), scene.beside.end());
  const Disks disks(std::move(all), cloud, options.radius);
  const std::vector<double> overhang = overhangs(scene, disks, cloud, options);
  const auto is_crown = [&](std::size_t k) {
    return k < roof.size() && overhang[k] > options.height;
  };
  const auto is_fringe = [&](std::size_t k) {
    bool found = false;
    if (overhang[k] > options.fringe)
      disks.in_disk(k, [&](std::size_t other) { found = found || is_crown(other); });
    return found;
  };
  std::vector<PointIndex> kept;
  for (std::size_t k = 0; k < roof.size(); ++k)
    if (!is_crown(k) && !is_fringe(k)) kept.push_back(roof[k]);
  // Chance makes surfaces in crowns too; where nearly all goes, so does the rest.
  const auto n = static_cast<double>(roof.size());
  const auto ground = static_cast<double>(below.size());
  const bool is_open = ground > kOpenGround * (ground + n);
  if (static_cast<double>(kept.size()) < (is_open ? kOpenRemainder : kRemainder) * n) return {};
  return kept;
}

bool has_trees_around(std::span<const PointIndex> roof, std::span<const PointIndex> around,
                      const PointCloud& cloud, double clearing) {
  if (roof.empty()) return false;
  double lowest = cloud.z[roof[0]];
  for (const PointIndex p : roof) lowest = std::min<double>(lowest, cloud.z[p]);
  const auto high = std::count_if(around.begin(), around.end(),
                                  [&](PointIndex p) { return cloud.z[p] > lowest + kTreeHeight; });
  return static_cast<double>(high) > clearing * static_cast<double>(roof.size());
}

}  // namespace

void drop_crowns(PointLists& roof, const CrownEvidence& evidence, const PointCloud& cloud,
                 const CrownOptions& options, const Progress& progress) {
  assert(roof.size() == evidence.below.size() && roof.size() == evidence.around.size() &&
         roof.size() == evidence.beside.size());
  std::vector<std::vector<PointIndex>> kept(roof.size());
  SharedProgress shared(progress, static_cast<std::int64_t>(roof.size()));
  parallel_chunks(roof.size(), kBuildingGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (has_trees_around(roof[b], evidence.around[b], cloud, options.clearing))
        kept[b] = without_crowns(
            {roof[b], evidence.below[b], evidence.around[b], evidence.beside[b]}, cloud, options);
      else
        kept[b].assign(roof[b].begin(), roof[b].end());
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  roof = to_rows(kept);
}

}  // namespace tetropolis
