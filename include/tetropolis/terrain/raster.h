// A regular grid of heights (the DTM), with values at its nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// nx x ny nodes; node (i, j) lies at (x0 + i * step, y0 + j * step) in the local frame and its
/// height is values[j * nx + i]: rows run west to east, the first row is the southernmost.
struct Raster {
  std::int32_t nx = 0;
  std::int32_t ny = 0;
  double x0 = 0;
  double y0 = 0;
  double step = 1;  ///< Metres between neighbouring nodes, > 0.
  std::vector<double> values;

  double at(std::int32_t i, std::int32_t j) const { return values[row_major(i, j, nx)]; }
  Bounds2 bounds() const { return {x0, y0, x0 + (nx - 1) * step, y0 + (ny - 1) * step}; }
};

/// Bilinear interpolation between the four nodes around `p`; positions outside the grid take the
/// value of the nearest position on its rim; NaN gives NaN. Precondition: nx, ny >= 1 and no value
/// is NaN.
double sample(const Raster& raster, Point2 p);

/// Rounds every value to single precision: at 500 m to 0.02 mm. Such a raster takes four bytes a
/// node in files, which give it back to the bit. NaN stays; what is beyond single precision becomes
/// infinite.
void round_to_single(Raster& raster);

/// The greatest value that sample() may give inside `box`: of the nodes of all grid cells that meet
/// it. Precondition: as sample; `box` is not empty.
double highest_under(const Raster& raster, const Bounds2& box);

}  // namespace tetropolis
