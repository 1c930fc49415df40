// Grey-scale morphology on grids: openings and closings with octagons. Private to src/terrain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/core/row_major.h"

namespace tetropolis {

/// nx x ny cells in rows, values[j * nx + i].
struct HeightGrid {
  std::int32_t nx = 0;
  std::int32_t ny = 0;
  std::vector<float> values;

  std::size_t index(std::int32_t i, std::int32_t j) const { return row_major(i, j, nx); }
};

/// Opens the grid with an octagon that reaches `radius` cells along the axes: each cell gets the
/// highest level at which an octagon that covers it fits under the surface. Cells outside of the
/// grid bound nothing. Guarantees: no value rises; the same for any number of threads. Linear in
/// cells, logarithmic in the radius; memory is two more grids. Precondition: radius >= 1, no NaN.
/// Source: Serra, "Image analysis and mathematical morphology" (1982); an octagon is the sum of
/// segments in four directions, and a segment the sum of segments of lengths that are powers of 2.
void open_with_octagon(HeightGrid& grid, std::int32_t radius);

/// The same upside down: no value falls.
void close_with_octagon(HeightGrid& grid, std::int32_t radius);

}  // namespace tetropolis
