#include "morphology.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace tetropolis {

namespace {

struct Lower {
  float operator()(float a, float b) const { return b < a ? b : a; }
};
struct Higher {
  float operator()(float a, float b) const { return a < b ? b : a; }
};

/// A step along one of the four directions.
struct Direction {
  std::int32_t i;
  std::int32_t j;
};

/// to(c) = the better of from(c) and from(c + steps * direction), where that lies on the grid.
template <typename Best>
void combine(const HeightGrid& from, HeightGrid& to, Direction direction, std::int32_t steps,
             const Best& best) {
  const std::int32_t shift = steps * direction.i;
  const std::int32_t low = std::clamp(-shift, 0, from.nx);
  const std::int32_t high = std::clamp(from.nx - shift, low, from.nx);
  const auto rows = static_cast<std::size_t>(from.ny);
  parallel_chunks(rows, 32, [&](std::size_t begin, std::size_t end) {
    for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j) {
      const float* here = from.values.data() + from.index(0, j);
      float* out = to.values.data() + to.index(0, j);
      std::copy(here, here + from.nx, out);
      const std::int32_t row = j + steps * direction.j;
      if (row < 0 || row >= from.ny) continue;
      const float* there = from.values.data() + from.index(0, row);
      for (std::int32_t i = low; i < high; ++i) out[i] = best(here[i], there[i + shift]);
    }
  });
}

/// The best value among those at most `half` steps away, both ways. `spare` is scratch.
template <typename Best>
void along(HeightGrid& grid, HeightGrid& spare, Direction direction, std::int32_t half,
           const Best& best) {
  // Each way alone: after the loop a cell knows the best of itself and `reach` steps ahead. Cells
  // whose way leads off the grid keep what they have, so that both ways together are exact.
  for (const std::int32_t sign : {1, -1}) {
    const Direction way{direction.i * sign, direction.j * sign};
    for (std::int32_t reach = 0; reach < half;) {
      const std::int32_t step = std::min(reach + 1, half - reach);
      combine(grid, spare, way, step, best);
      std::swap(grid.values, spare.values);
      reach += step;
    }
  }
}

template <typename Best>
void sweep(HeightGrid& grid, HeightGrid& spare, std::int32_t radius, const Best& best) {
  // Sides of equal length, as nearly as cells allow. Diagonals alone would leave out every other
  // cell, so some step along the axes remains.
  const auto diagonal = std::min(
      static_cast<std::int32_t>(std::lround(radius * (1 - 1 / std::sqrt(2.0)))), (radius - 1) / 2);
  const std::int32_t straight = radius - 2 * diagonal;
  along(grid, spare, {1, 0}, straight, best);
  along(grid, spare, {0, 1}, straight, best);
  along(grid, spare, {1, 1}, diagonal, best);
  along(grid, spare, {1, -1}, diagonal, best);
}

}  // namespace

void open_with_octagon(HeightGrid& grid, std::int32_t radius) {
  HeightGrid spare{grid.nx, grid.ny, std::vector<float>(grid.values.size())};
  const std::vector<float> before = grid.values;
  sweep(grid, spare, radius, Lower{});
  sweep(grid, spare, radius, Higher{});
  // At the rim segments are cut; what that adds must not raise anything.
  for (std::size_t c = 0; c < grid.values.size(); ++c)
    grid.values[c] = std::min(grid.values[c], before[c]);
}

void close_with_octagon(HeightGrid& grid, std::int32_t radius) {
  const auto turn_over = [&] {
    for (float& value : grid.values) value = -value;
  };
  turn_over();
  open_with_octagon(grid, radius);
  turn_over();
}

}  // namespace tetropolis
