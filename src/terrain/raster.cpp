#include "tetropolis/terrain/raster.h"

#include <algorithm>
#include <cmath>

namespace tetropolis {

namespace {

/// Splits a coordinate in grid units into the cell's lower node and the share of the way to the
/// next.
struct Cell {
  std::int32_t index;
  double share;
};

Cell locate(double position, std::int32_t nodes) {
  const double clamped = std::clamp(position, 0.0, static_cast<double>(nodes - 1));
  if (std::isnan(clamped)) return {0, clamped};
  const auto index =
      std::min(static_cast<std::int32_t>(clamped), std::max<std::int32_t>(nodes - 2, 0));
  return {index, clamped - index};
}

}  // namespace

double sample(const Raster& raster, Point2 p) {
  const Cell cx = locate((p.x - raster.x0) / raster.step, raster.nx);
  const Cell cy = locate((p.y - raster.y0) / raster.step, raster.ny);
  const std::int32_t i1 = std::min(cx.index + 1, raster.nx - 1);
  const std::int32_t j1 = std::min(cy.index + 1, raster.ny - 1);
  const double south =
      raster.at(cx.index, cy.index) * (1 - cx.share) + raster.at(i1, cy.index) * cx.share;
  const double north = raster.at(cx.index, j1) * (1 - cx.share) + raster.at(i1, j1) * cx.share;
  return south * (1 - cy.share) + north * cy.share;
}

void round_to_single(Raster& raster) {
  for (double& value : raster.values) value = static_cast<float>(value);
}

double highest_under(const Raster& raster, const Bounds2& box) {
  const auto node = [&](double position, double origin, std::int32_t nodes, auto round) {
    return static_cast<std::int32_t>(
        std::clamp(round((position - origin) / raster.step), 0.0, static_cast<double>(nodes - 1)));
  };
  const auto down = [](double x) { return std::floor(x); };
  const auto up = [](double x) { return std::ceil(x); };
  const std::int32_t west = node(box.xmin, raster.x0, raster.nx, down);
  const std::int32_t east = node(box.xmax, raster.x0, raster.nx, up);
  const std::int32_t south = node(box.ymin, raster.y0, raster.ny, down);
  const std::int32_t north = node(box.ymax, raster.y0, raster.ny, up);
  double highest = raster.at(west, south);
  for (std::int32_t j = south; j <= north; ++j)
    for (std::int32_t i = west; i <= east; ++i) highest = std::max(highest, raster.at(i, j));
  return highest;
}

}  // namespace tetropolis
