#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/ground_filter.h"

namespace tetropolis {

namespace {

constexpr double kMostCells = 134217728.0;  // 2^27

/// Cell (i, j) has its centre at (x0 + i * cell, y0 + j * cell).
struct Cells {
  double x0 = 0;
  double y0 = 0;
  double cell = 1;
  std::int32_t nx = 0;
  std::int32_t ny = 0;
  std::vector<float> distance;  ///< To the nearest cell outside, in cells.

  float* row(std::int32_t j) {
    return distance.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
  }
};

/// Marks the cells whose centres lie inside, by the even-odd rule along each row; so broken rings
/// do no harm.
void paint(const Polygon& polygon, Cells& cells, float inside) {
  const Bounds2 box = bounds(polygon);
  const auto row_of = [&](double y) {
    return static_cast<std::int32_t>(
        std::clamp(std::ceil((y - cells.y0) / cells.cell), 0.0, static_cast<double>(cells.ny)));
  };
  const auto column_of = [&](double x) {
    return static_cast<std::int32_t>(
        std::clamp(std::ceil((x - cells.x0) / cells.cell), 0.0, static_cast<double>(cells.nx)));
  };
  std::vector<double> crossings;
  for (std::int32_t j = row_of(box.ymin); j < row_of(box.ymax); ++j) {
    const double y = cells.y0 + j * cells.cell;
    crossings.clear();
    for_each_edge(polygon, [&](Point2 a, Point2 b) {
      if ((a.y <= y) != (b.y <= y))
        crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    });
    std::sort(crossings.begin(), crossings.end());
    float* row = cells.row(j);
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
      std::fill(row + column_of(crossings[k]),
                row + std::max(column_of(crossings[k]), column_of(crossings[k + 1])), inside);
  }
}

/// Chamfer distances in two passes (Borgefors, "Distance transformations in digital images", 1986).
/// What is off the grid counts as inside: a building cut by the rim is as wide as it may be.
void measure(Cells& cells) {
  const float diagonal = std::sqrt(2.0F);
  for (const std::int32_t way : {1, -1}) {
    for (std::int32_t n = 0; n < cells.ny; ++n) {
      const std::int32_t j = way > 0 ? n : cells.ny - 1 - n;
      const std::int32_t before = j - way;
      float* row = cells.row(j);
      const auto lower = [&](std::int32_t i, float value) { row[i] = std::min(row[i], value); };
      if (before >= 0 && before < cells.ny) {
        const float* other = cells.row(before);
        for (std::int32_t i = 0; i < cells.nx; ++i) {
          lower(i, other[i] + 1);
          if (i > 0) lower(i, other[i - 1] + diagonal);
          if (i + 1 < cells.nx) lower(i, other[i + 1] + diagonal);
        }
      }
      for (std::int32_t i = 1; i < cells.nx; ++i) lower(i, row[i - 1] + 1);
      for (std::int32_t i = cells.nx - 2; i >= 0; --i) lower(i, row[i + 1] + 1);
    }
  }
}

}  // namespace

double widest_inscribed_radius(std::span<const Polygon> footprints, const Bounds2& extent,
                               double cell) {
  if (extent.empty()) return 0;
  Cells cells;
  cells.cell = std::max(cell, std::sqrt(extent.width() * extent.height() / kMostCells));
  cells.x0 = extent.xmin;
  cells.y0 = extent.ymin;
  cells.nx = static_cast<std::int32_t>(extent.width() / cells.cell) + 1;
  cells.ny = static_cast<std::int32_t>(extent.height() / cells.cell) + 1;
  cells.distance.assign(static_cast<std::size_t>(cells.nx) * static_cast<std::size_t>(cells.ny), 0);
  const auto far = static_cast<float>(cells.nx + cells.ny);
  for (const Polygon& footprint : footprints) paint(footprint, cells, far);
  measure(cells);
  const float widest = *std::max_element(cells.distance.begin(), cells.distance.end());
  return static_cast<double>(widest) * cells.cell;
}

}  // namespace tetropolis
