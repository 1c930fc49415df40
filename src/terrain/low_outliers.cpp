#include "low_outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/median.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

/// A lowest point is a low outlier unless this many cells, itself among them, hold one at most
/// kOutlierRise higher within kOutlierReach.
constexpr int kOutlierSupport = 4;
constexpr double kOutlierRise = 1.0;
constexpr double kOutlierReach = 10.0;

/// Where low outliers are many they support each other. So a low outlier is, too, what has higher
/// points all around and hardly any at its level, kOutlierRise up and down: in at most kMostAlone
/// of the 25 cells around, and in less than this area in square metres, if one of two holds:
constexpr std::int32_t kRing = 2;
constexpr int kMostAlone = 4;
constexpr double kMostAloneArea = 5;
/// - what is around is smooth, within this of a plane, as crowns are not;
constexpr double kRough = 0.5;
/// - within kOutlierReach its level has less than this share of the cells of the commonest one
/// above.
constexpr double kOutlierShare = 0.06;

/// Where there are points in nearly all cells, what is left is looked at again, this often at most:
/// with its neighbours gone, one more low outlier may be alone. In sparse clouds yards would go
/// that way.
constexpr int kOutlierRounds = 3;

/// Points are around if this share of the 24 cells has higher ones (or smooth ones), as far as they
/// can be expected to hold any: at water that returns little it is voids that are around.
constexpr double kSurrounded = 0.6;

/// Whether enough cells around (i, j) hold points at most kOutlierRise higher. Rings from the
/// inside out: almost always the first one settles it.
bool is_supported(const HeightGrid& grid, std::int32_t i, std::int32_t j, std::int32_t reach) {
  const float most = grid.values[grid.index(i, j)] + static_cast<float>(kOutlierRise);
  int support = 1;
  const auto look = [&](std::int32_t ni, std::int32_t nj) {
    if (ni < 0 || nj < 0 || ni >= grid.nx || nj >= grid.ny) return;
    if (grid.values[grid.index(ni, nj)] <= most) ++support;
  };
  for (std::int32_t ring = 1; ring <= reach && support < kOutlierSupport; ++ring) {
    for (std::int32_t k = -ring; k <= ring; ++k) {
      look(i + k, j - ring);
      look(i + k, j + ring);
    }
    for (std::int32_t k = -ring + 1; k < ring; ++k) {
      look(i - ring, j + k);
      look(i + ring, j + k);
    }
  }
  return support >= kOutlierSupport;
}

/// What low outliers that are many are told by.
struct OutlierLimits {
  double higher = 0;   ///< Share of the cells around that have to hold higher points.
  int most_alone = 0;  ///< Cells that may share the level, at most.
};

/// Cells that are expected to hold points are 1 - exp(-cell^2 / spacing^2) of all.
OutlierLimits outlier_limits(double cell, double spacing) {
  return {kSurrounded * (1 - std::exp(-(cell * cell) / (spacing * spacing))),
          static_cast<int>(std::min<double>(kMostAlone, kMostAloneArea / (cell * cell)))};
}

/// Columns and rows [i0, i1] x [j0, j1] of cells.
struct Block {
  std::int32_t i0, i1, j0, j1;

  int cells() const { return (i1 - i0 + 1) * (j1 - j0 + 1); }
  /// Those within kRing of a cell.
  Block around(std::int32_t i, std::int32_t j) const {
    return {std::max(i - kRing, i0), std::min(i + kRing, i1), std::max(j - kRing, j0),
            std::min(j + kRing, j1)};
  }
  /// How many cells around one, itself left out, are the given share.
  int share(double share) const { return static_cast<int>(std::ceil(share * (cells() - 1))); }
};

/// The least block with all cells that hold points: beyond the rim of the cloud there is nothing to
/// be expected. Precondition: there are some.
Block block_with_points(const HeightGrid& grid) {
  Block block{grid.nx, -1, grid.ny, -1};
  for (std::int32_t j = 0; j < grid.ny; ++j)
    for (std::int32_t i = 0; i < grid.nx; ++i) {
      if (std::isnan(grid.values[grid.index(i, j)])) continue;
      block.i0 = std::min(block.i0, i);
      block.i1 = std::max(block.i1, i);
      block.j0 = std::min(block.j0, j);
      block.j1 = j;
    }
  return block;
}

/// Whether the cells around (i, j) hold higher points and next to none at its level.
bool is_surrounded(const HeightGrid& grid, std::int32_t i, std::int32_t j, const Block& around,
                   const OutlierLimits& limits) {
  const float z = grid.values[grid.index(i, j)];
  const auto rise = static_cast<float>(kOutlierRise);
  const int needed = around.share(limits.higher);
  int left = around.cells();
  int higher = 0, level = 0;
  for (std::int32_t nj = around.j0; nj <= around.j1; ++nj)
    for (std::int32_t ni = around.i0; ni <= around.i1; ++ni) {
      const float other = grid.values[grid.index(ni, nj)];
      if (other > z + rise)
        ++higher;
      else if (other >= z - rise && ++level > limits.most_alone)
        return false;
      if (higher + --left < needed) return false;
    }
  return true;
}

/// Whether the cells around (i, j) lie in one plane above it, as many as are needed. The plane is
/// that of the medians, which other low outliers and roofs do not tilt. `room` is to work in.
bool is_under_plane(const HeightGrid& grid, std::int32_t i, std::int32_t j, const Block& around,
                    const OutlierLimits& limits, std::vector<float>& room) {
  const auto at = [&](std::int32_t ni, std::int32_t nj) { return grid.values[grid.index(ni, nj)]; };
  const auto rise_along = [&](std::int32_t di, std::int32_t dj) {
    room.clear();
    for (std::int32_t nj = around.j0; nj <= around.j1 - dj; ++nj)
      for (std::int32_t ni = around.i0; ni <= around.i1 - di; ++ni) {
        const float step = at(ni + di, nj + dj) - at(ni, nj);
        if (!std::isnan(step)) room.push_back(step);
      }
    return room.empty() ? 0 : median(room);
  };
  const float rise_x = rise_along(1, 0), rise_y = rise_along(0, 1);
  room.clear();
  for (std::int32_t nj = around.j0; nj <= around.j1; ++nj)
    for (std::int32_t ni = around.i0; ni <= around.i1; ++ni) {
      const float level =
          at(ni, nj) - rise_x * static_cast<float>(ni - i) - rise_y * static_cast<float>(nj - j);
      if (!std::isnan(level)) room.push_back(level);
    }
  const float plane = median(room);
  if (plane - at(i, j) <= static_cast<float>(kOutlierRise)) return false;
  const auto smooth = std::count_if(room.begin(), room.end(), [&](float level) {
    return std::abs(level - plane) <= static_cast<float>(kRough);
  });
  return smooth >= around.share(limits.higher);
}

/// Whether few cells within `reach` share the level of (i, j), compared with the commonest level
/// above. `higher` is room to work in.
bool is_rare(const HeightGrid& grid, std::int32_t i, std::int32_t j, std::int32_t reach,
             std::vector<float>& higher) {
  const float z = grid.values[grid.index(i, j)];
  const auto rise = static_cast<float>(kOutlierRise);
  higher.clear();
  int level = 0;
  for (std::int32_t nj = std::max(j - reach, 0); nj <= std::min(j + reach, grid.ny - 1); ++nj)
    for (std::int32_t ni = std::max(i - reach, 0); ni <= std::min(i + reach, grid.nx - 1); ++ni) {
      const float other = grid.values[grid.index(ni, nj)];
      if (other > z + rise)
        higher.push_back(other);
      else if (other >= z - rise)
        ++level;
    }
  if (level < kOutlierSupport) return true;
  const double most = static_cast<double>(level) / kOutlierShare;
  if (static_cast<double>(higher.size()) <= most) return false;
  std::sort(higher.begin(), higher.end());
  std::size_t commonest = 0;
  for (std::size_t first = 0, last = 0; last < higher.size(); ++last) {
    while (higher[last] - higher[first] > 2 * rise) ++first;
    commonest = std::max(commonest, last - first + 1);
  }
  return static_cast<double>(commonest) > most;
}

/// The cells within kRing of these.
std::vector<std::uint8_t> cells_near(const std::vector<std::uint8_t>& chosen,
                                     const HeightGrid& grid) {
  std::vector<std::uint8_t> near(chosen.size(), 0);
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    if (chosen[c] == 0) continue;
    const auto nx = static_cast<std::size_t>(grid.nx);
    const auto i = static_cast<std::int32_t>(c % nx), j = static_cast<std::int32_t>(c / nx);
    const std::int32_t i0 = std::max(i - kRing, 0), i1 = std::min(i + kRing, grid.nx - 1);
    for (std::int32_t nj = std::max(j - kRing, 0); nj <= std::min(j + kRing, grid.ny - 1); ++nj)
      std::fill(near.begin() + static_cast<std::ptrdiff_t>(grid.index(i0, nj)),
                near.begin() + static_cast<std::ptrdiff_t>(grid.index(i1, nj)) + 1,
                std::uint8_t{1});
  }
  return near;
}

}  // namespace

void remove_low_outliers(HeightGrid& grid, HeightGrid all, double cell, double spacing) {
  const auto reach = static_cast<std::int32_t>(std::max(std::ceil(kOutlierReach / cell), 2.0));
  const OutlierLimits limits = outlier_limits(cell, spacing);
  const Block block = block_with_points(all);
  const int rounds = limits.most_alone == kMostAlone ? kOutlierRounds : 1;
  std::vector<std::uint8_t> open(grid.values.size(), 1);
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint8_t> outlier(grid.values.size(), 0);
    parallel_chunks(static_cast<std::size_t>(grid.ny), 32, [&](std::size_t begin, std::size_t end) {
      std::vector<float> room;
      for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j)
        for (std::int32_t i = 0; i < grid.nx; ++i) {
          const std::size_t c = grid.index(i, j);
          if (open[c] == 0 || std::isnan(grid.values[c])) continue;
          const Block around = block.around(i, j);
          if (!is_supported(grid, i, j, reach) ||
              (is_surrounded(all, i, j, around, limits) &&
               (is_under_plane(all, i, j, around, limits, room) ||
                is_rare(grid, i, j, reach, room))))
            outlier[c] = 1;
        }
    });
    bool found = false;
    for (std::size_t c = 0; c < outlier.size(); ++c) {
      if (outlier[c] == 0) continue;
      grid.values[c] = all.values[c] = std::numeric_limits<float>::quiet_NaN();
      found = true;
    }
    if (!found) break;
    if (round + 1 < rounds) open = cells_near(outlier, grid);
  }
}

}  // namespace tetropolis
