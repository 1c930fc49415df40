// What is known of points and footprints before the work: how well they fit together.
#pragma once

#include <cstdint>
#include <optional>

#include "tetropolis/geometry/types.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

struct Preflight {
  double overlap = 0;           ///< Share of the footprints' box that the box of the points covers.
  double points_per_m2 = 0;     ///< Of their box.
  std::int64_t footprints = 0;  ///< In the bounds, if there are any.
  std::int64_t footprints_with_points = 0;  ///< Of these, with a point inside.
};

/// Of input as build_city takes it; `extent` of the points is needed. `bounds`: CRS coordinates;
/// none: all footprints count. Without footprints the overlap is 0.
Preflight preflight(const PointsInput& points, const FootprintsInput& footprints,
                    const std::optional<Bounds2>& bounds);

}  // namespace tetropolis
