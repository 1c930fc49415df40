// Grids as arrays of rows.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tetropolis {

/// Where cell (i, j) of a grid stands in the array of its rows, each of `columns` cells.
constexpr std::size_t row_major(std::int64_t i, std::int64_t j, std::int64_t columns) {
  return static_cast<std::size_t>(j * columns + i);
}

}  // namespace tetropolis
