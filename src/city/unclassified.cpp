#include "city/unclassified.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "city/footprint_index.h"

namespace tetropolis {

namespace {

constexpr double kSquare = 100;  // metres
constexpr std::int64_t kMoreEmpty = 3;

using Square = std::pair<std::int64_t, std::int64_t>;

Square square_of(const Polygon& footprint) {
  const Bounds2 box = bounds(footprint);
  return {static_cast<std::int64_t>(std::floor((box.xmin + box.xmax) / 2 / kSquare)),
          static_cast<std::int64_t>(std::floor((box.ymin + box.ymax) / 2 / kSquare))};
}

/// Per building, 1 where those around it have no points, but for a few.
std::vector<std::uint8_t> find_outvoted(std::span<const Polygon* const> footprints,
                                        const PointLists& roof) {
  std::map<Square, std::int64_t> balance;  // Lists with points less those without.
  for (std::size_t b = 0; b < footprints.size(); ++b)
    balance[square_of(*footprints[b])] += roof[b].empty() ? -1 : 1;
  std::vector<std::uint8_t> outvoted(footprints.size(), 0);
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    const auto [column, row] = square_of(*footprints[b]);
    std::int64_t sum = 0;
    for (std::int64_t i = column - 1; i <= column + 1; ++i)
      for (std::int64_t j = row - 1; j <= row + 1; ++j)
        if (const auto found = balance.find({i, j}); found != balance.end()) sum += found->second;
    outvoted[b] = sum <= -kMoreEmpty ? 1 : 0;
  }
  return outvoted;
}

}  // namespace

std::vector<BuildingIndex> find_unclassified(std::span<const Polygon* const> footprints,
                                             const PointLists& roof, const PointCloud& cloud,
                                             std::span<const PointRange> ranges) {
  const std::vector<std::uint8_t> outvoted = find_outvoted(footprints, roof);
  std::vector<std::size_t> inside_of(footprints.size(), 0);
  if (!ranges.empty()) {
    const FootprintIndex index(footprints, 0);
    for (const PointRange& range : ranges)
      for (std::size_t p = range.begin; p < range.end; ++p)
        index.at({cloud.x[p], cloud.y[p]}, [&](BuildingIndex building, bool inside) {
          inside_of[static_cast<std::size_t>(building)] += inside ? 1 : 0;
        });
  }
  std::vector<BuildingIndex> result;
  for (std::size_t b = 0; b < footprints.size(); ++b)
    if ((roof[b].empty() && outvoted[b] != 0) || inside_of[b] > roof[b].size())
      result.push_back(static_cast<BuildingIndex>(b));
  return result;
}

}  // namespace tetropolis
