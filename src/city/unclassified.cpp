#include "city/unclassified.h"

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "tetropolis/core/parallel.h"

#include "city/footprint_index.h"

namespace tetropolis {

namespace {

constexpr double kSquare = 100;  // metres
constexpr std::int64_t kMoreEmpty = 3;
constexpr std::size_t kPointGrain = std::size_t{1} << 15;

using Square = std::pair<std::int64_t, std::int64_t>;

/// Precondition: not empty.
Square square_of(const Bounds2& box) {
  return {static_cast<std::int64_t>(std::floor((box.xmin + box.xmax) / 2 / kSquare)),
          static_cast<std::int64_t>(std::floor((box.ymin + box.ymax) / 2 / kSquare))};
}

/// Per building, 1 where those around it have no points, but for a few.
std::vector<std::uint8_t> find_outvoted(std::span<const Polygon* const> footprints,
                                        const PointLists& roof) {
  std::map<Square, std::int64_t> balance;  // Lists with points less those without.
  for (std::size_t b = 0; b < footprints.size(); ++b)
    if (const Bounds2 box = bounds(*footprints[b]); !box.empty())
      balance[square_of(box)] += roof[b].empty() ? -1 : 1;
  std::vector<std::uint8_t> outvoted(footprints.size(), 0);
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    const Bounds2 box = bounds(*footprints[b]);
    if (box.empty()) continue;
    const auto [column, row] = square_of(box);
    std::int64_t sum = 0;
    for (std::int64_t i = column - 1; i <= column + 1; ++i)
      for (std::int64_t j = row - 1; j <= row + 1; ++j)
        if (const auto found = balance.find({i, j}); found != balance.end()) sum += found->second;
    outvoted[b] = sum <= -kMoreEmpty ? 1 : 0;
  }
  return outvoted;
}

/// How many points of the ranges are inside each footprint.
std::vector<std::uint32_t> count_inside(std::span<const Polygon* const> footprints,
                                        const PointCloud& cloud, std::span<const PointRange> ranges,
                                        const Progress& progress) {
  std::vector<std::uint32_t> counts(footprints.size(), 0);
  const FootprintIndex index(footprints, 0);
  std::int64_t all = 0;
  for (const PointRange& range : ranges) all += static_cast<std::int64_t>(range.end - range.begin);
  SharedProgress shared(progress, all);
  for (const PointRange& range : ranges)
    parallel_chunks(range.end - range.begin, kPointGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = range.begin + begin; p < range.begin + end; ++p)
        index.at({cloud.x[p], cloud.y[p]}, [&](BuildingIndex building, bool inside) {
          if (inside)
            std::atomic_ref(counts[static_cast<std::size_t>(building)])
                .fetch_add(1, std::memory_order_relaxed);
        });
      shared.add(static_cast<std::int64_t>(end - begin));
    });
  return counts;
}

}  // namespace

Unclassified find_unclassified(std::span<const Polygon* const> footprints, const PointLists& roof,
                               const PointCloud& cloud, std::span<const PointRange> ranges,
                               const Progress& progress) {
  const std::vector<std::uint8_t> outvoted = find_outvoted(footprints, roof);
  std::vector<std::uint32_t> inside(footprints.size(), 0);
  if (!ranges.empty()) inside = count_inside(footprints, cloud, ranges, progress);
  Unclassified result;
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    const bool in_ranges = inside[b] > roof[b].size();
    if (!in_ranges && (outvoted[b] == 0 || !roof[b].empty())) continue;
    result.buildings.push_back(static_cast<BuildingIndex>(b));
    result.in_ranges.push_back(in_ranges ? 1 : 0);
  }
  return result;
}

}  // namespace tetropolis
