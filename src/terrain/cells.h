// The square cells that the ground filter works on. Private to src/terrain.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Metres: what stands up by this much within a cell or two is no terrain.
inline constexpr double kStorey = 3.0;

/// Cells over the candidates and a margin around them. Cell (i, j) is number (first_i + i,
/// first_j + j) from the anchor, a corner of cells.
struct Frame {
  Point2 anchor;
  double cell = 1;
  double first_i = 0;  ///< A whole number.
  double first_j = 0;
  std::int32_t nx = 0;
  std::int32_t ny = 0;

  std::size_t at(double x, double y) const {
    const auto index = [&](double offset, double first, std::int32_t cells) {
      return static_cast<std::size_t>(
          std::clamp(std::floor(offset / cell) - first, 0.0, cells - 1.0));
    };
    return index(y - anchor.y, first_j, ny) * static_cast<std::size_t>(nx) +
           index(x - anchor.x, first_i, nx);
  }
  /// Of column i and row j.
  Point2 centre(std::int32_t i, std::int32_t j) const {
    return {anchor.x + (first_i + i + 0.5) * cell, anchor.y + (first_j + j + 0.5) * cell};
  }
};

/// Calls use(n) for the cells n that share a side with cell c.
template <typename Use>
void for_each_neighbour(const Frame& frame, std::size_t c, const Use& use) {
  const auto columns = static_cast<std::size_t>(frame.nx);
  const std::size_t i = c % columns;
  if (i > 0) use(c - 1);
  if (i + 1 < columns) use(c + 1);
  if (c >= columns) use(c - columns);
  if (c + columns < columns * static_cast<std::size_t>(frame.ny)) use(c + columns);
}

}  // namespace tetropolis
