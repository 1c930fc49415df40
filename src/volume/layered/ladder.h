// Heights of layers that all columns share, for cells that are prisms.
#pragma once

#include <vector>

namespace tetropolis {

struct LadderSpacing {
  double first = 1;     ///< Metres, > 0, likewise the others.
  double growth = 1.2;  ///< From one to the next, at most; >= 1.
  double canopy = 5;    ///< Between buildings, at most,
  double far = 20;      ///< and above them.
};

/// Elevations from `bottom` to `top`, both included, bottom < top: layers grow from the first to
/// spacing.canopy, and above `roofs`, the highest of them, to spacing.far. All are stretched alike,
/// by less than half a layer in all, so that they end at the top. At least two layers.
std::vector<double> make_ladder(double bottom, double roofs, double top,
                                const LadderSpacing& spacing);

}  // namespace tetropolis
