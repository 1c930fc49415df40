#include "stray_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/parallel.h"

namespace tetropolis {

namespace {

// As wide as no gap within a city is; in a wide domain, so wide that it is worth leaving out.
constexpr double kLeastGap = 100;       // metres
constexpr double kLeastGapShare = 0.1;  // of the extent
constexpr std::size_t kFew = 10;        // points; a tile's corner has more
constexpr std::size_t kMany = 100;      // points in all; a twentieth of a small cloud
constexpr std::size_t kBins = 1000;     // a hundred in the least gap of a wide domain
constexpr std::size_t kGrain = std::size_t{1} << 20;

using Counts = std::array<std::int64_t, kBins>;

/// How many points of the box, of every `stride`-th, lie in each of the equal parts of [low, high].
Counts count_along(const PointCloud& cloud, std::size_t stride,
                   const Buffer<PointCoordinate>& along, double low, double high,
                   const Bounds2& box) {
  const double per_metre = kBins / (high - low);
  return parallel_reduce_ordered(
      cloud.size() / stride, kGrain, Counts{},
      [&](std::size_t begin, std::size_t end) {
        Counts counts{};
        for (std::size_t p = begin * stride; p < end * stride; p += stride) {
          if (!box.contains({cloud.x[p], cloud.y[p]})) continue;
          const double bin = (along[p] - low) * per_metre;
          ++counts[std::min(static_cast<std::size_t>(std::max(bin, 0.0)), kBins - 1)];
        }
        return counts;
      },
      [](Counts a, const Counts& b) {
        for (std::size_t i = 0; i < kBins; ++i) a[i] += b[i];
        return a;
      });
}

/// How many bins at the beginning hold strays and the gap behind them.
std::size_t leading_strays(const Counts& counts, std::int64_t few, std::size_t gap) {
  std::int64_t before = 0;
  std::size_t cut = 0, empty = 0;
  for (std::size_t i = 0; i < kBins && before <= few; ++i) {
    if (counts[i] == 0) {
      ++empty;
      continue;
    }
    if (before > 0 && empty >= gap) cut = i;
    before += counts[i];
    empty = 0;
  }
  return cut;
}

/// Whether so many bins in a row are empty.
bool has_gap(const Counts& counts, std::size_t gap) {
  std::size_t empty = 0;
  return std::any_of(counts.begin(), counts.end(), [&](std::int64_t count) {
    empty = count == 0 ? empty + 1 : 0;
    return empty >= gap;
  });
}

/// Moves the sides of [low, high], those of the box, inwards past strays; false if there are none.
bool cut_range(const PointCloud& cloud, const Buffer<PointCoordinate>& along, const Bounds2& box,
               std::int64_t few, double& low, double& high) {
  const double width = (high - low) / kBins;
  const double metres = std::max(kLeastGap, kLeastGapShare * (high - low));
  const auto gap = static_cast<std::size_t>(std::ceil(metres / width));
  // Where a few of the points leave no gap, all of them leave none.
  constexpr std::size_t kSome = 64;
  if (!has_gap(count_along(cloud, kSome, along, low, high, box), gap)) return false;
  Counts counts = count_along(cloud, 1, along, low, high, box);
  const std::size_t first = leading_strays(counts, few, gap);
  std::reverse(counts.begin(), counts.end());
  const std::size_t last = leading_strays(counts, few, gap);
  low += static_cast<double>(first) * width;
  high -= static_cast<double>(last) * width;
  return first + last > 0;
}

/// Of the points in the box.
Bounds2 extent_within(const PointCloud& cloud, const Bounds2& box) {
  return parallel_reduce_ordered(
      cloud.size(), kGrain, Bounds2::nothing(),
      [&](std::size_t begin, std::size_t end) {
        Bounds2 extent = Bounds2::nothing();
        for (std::size_t p = begin; p < end; ++p)
          if (const Point2 point{cloud.x[p], cloud.y[p]}; box.contains(point)) extent.extend(point);
        return extent;
      },
      [](Bounds2 a, const Bounds2& b) {
        if (!b.empty()) a.extend(b);
        return a;
      });
}

}  // namespace

StrayPoints find_stray_points(const PointCloud& cloud, const Bounds2& extent) {
  const auto few = static_cast<std::int64_t>(std::min(kFew, cloud.size() / 100));
  Bounds2 box = extent;
  // Each cut takes a tenth of a side, so this ends.
  for (bool cut = true; cut;) {
    cut = false;
    if (box.width() > kLeastGap) cut = cut_range(cloud, cloud.x, box, few, box.xmin, box.xmax);
    if (box.height() > kLeastGap)
      cut = cut_range(cloud, cloud.y, box, few, box.ymin, box.ymax) || cut;
    if (cut) box = extent_within(cloud, box);
  }
  StrayPoints strays{{}, box};
  if (box.covers(extent)) return strays;
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (!box.contains({cloud.x[p], cloud.y[p]})) strays.points.push_back(p);
  if (strays.points.size() > std::min(kMany, cloud.size() / 20)) return {{}, extent};
  return strays;
}

}  // namespace tetropolis
