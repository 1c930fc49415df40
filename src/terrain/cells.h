// The square cells that the ground filter works on. Private to src/terrain.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tetropolis {

/// Metres: what stands up by this much within a cell or two is no terrain.
inline constexpr double kStorey = 3.0;

/// Cells over the candidates and a margin around them.
struct Frame {
  double x0 = 0;
  double y0 = 0;
  double cell = 1;
  std::int32_t nx = 0;
  std::int32_t ny = 0;

  std::size_t at(double x, double y) const {
    const auto i = static_cast<std::int32_t>(std::clamp((x - x0) / cell, 0.0, nx - 1.0));
    const auto j = static_cast<std::int32_t>(std::clamp((y - y0) / cell, 0.0, ny - 1.0));
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
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
