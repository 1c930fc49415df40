#include "depressions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tetropolis/core/row_major.h"

namespace tetropolis {

namespace {

constexpr double kHalfWidth = 3.0;  // metres, of depressions
constexpr double kHalfWide = 4.0;   // metres to the next depression; greenhouses are 8 m wide
constexpr float kDeepest = 1.2F * static_cast<float>(kStorey);
constexpr float kShallowest = 0.3F;  // metres, less than objects and more than noise

/// Cells of depressions for each one that is wide, at most. Ditches 4 m wide at a pitch of 17 m
/// have as many of both, garages, sheds, hedges and greenhouses hardly any that are wide.
constexpr std::int32_t kMostDepression = 2;

/// Cells without a value that are next to one with a value get the lowest of these: where points
/// are sparse, many cells are empty by chance.
HeightGrid with_small_voids_filled(const HeightGrid& grid, const Frame& frame) {
  HeightGrid filled = grid;
  for (std::size_t c = 0; c < grid.values.size(); ++c) {
    if (!std::isnan(grid.values[c])) continue;
    for_each_neighbour(frame, c, [&](std::size_t n) {
      const float z = grid.values[n];
      if (!std::isnan(z) && !(filled.values[c] <= z)) filled.values[c] = z;
    });
  }
  return filled;
}

/// How many cells of a mask lie in a square, by a summed-area table (Crow, "Summed-area tables for
/// texture mapping", 1984).
class CellCounts {
 public:
  template <typename Is>
  CellCounts(const Frame& frame, const Is& is) : columns_(frame.nx + 1), rows_(frame.ny + 1) {
    sums_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
    std::size_t c = 0;
    for (std::int32_t j = 1; j < rows_; ++j) {
      std::int32_t row = 0;
      for (std::int32_t i = 1; i < columns_; ++i, ++c) {
        row += is(c, i - 1, j - 1) ? 1 : 0;
        sums_[at(i, j)] = sums_[at(i, j - 1)] + row;
      }
    }
  }

  /// Within `reach` cells of cell (i, j) to each side.
  std::int32_t around(std::int32_t i, std::int32_t j, std::int32_t reach) const {
    const std::int32_t i0 = std::max(i - reach, 0), i1 = std::min(i + reach + 1, columns_ - 1);
    const std::int32_t j0 = std::max(j - reach, 0), j1 = std::min(j + reach + 1, rows_ - 1);
    return sums_[at(i1, j1)] - sums_[at(i0, j1)] - sums_[at(i1, j0)] + sums_[at(i0, j0)];
  }

 private:
  std::size_t at(std::int32_t i, std::int32_t j) const { return row_major(i, j, columns_); }

  std::int32_t columns_;
  std::int32_t rows_;
  std::vector<std::int32_t> sums_;
};

}  // namespace

void fill_depressions(HeightGrid& grid, const Frame& frame, double window) {
  const auto cells = [&](double metres) {
    return std::max(static_cast<std::int32_t>(std::lround(metres / frame.cell)), 1);
  };
  HeightGrid closed = with_small_voids_filled(grid, frame);
  for (float& z : closed.values)
    if (std::isnan(z)) z = std::numeric_limits<float>::infinity();
  close_with_octagon(closed, cells(kHalfWidth));
  const auto depth = [&](std::size_t c) { return closed.values[c] - grid.values[c]; };
  const CellCounts depression(frame, [&](std::size_t c, std::int32_t, std::int32_t) {
    return depth(c) > kShallowest && depth(c) <= kDeepest;
  });
  const std::int32_t half_wide = cells(kHalfWide);
  const CellCounts wide(frame, [&](std::size_t c, std::int32_t i, std::int32_t j) {
    return !std::isnan(grid.values[c]) && depression.around(i, j, half_wide) == 0;
  });
  const std::int32_t reach = cells(window);
  std::size_t c = 0;
  for (std::int32_t j = 0; j < frame.ny; ++j)
    for (std::int32_t i = 0; i < frame.nx; ++i, ++c)
      if (depth(c) <= kDeepest &&
          depression.around(i, j, reach) <= kMostDepression * wide.around(i, j, reach))
        grid.values[c] = closed.values[c];
}

}  // namespace tetropolis
