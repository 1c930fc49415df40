// The lines of a building's parts. Private to the library.
#pragma once

#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/types.h"

#include "core/infinity.h"

namespace tetropolis {

struct LineClearance {
  /// Between two corners, or a corner and a line that it is no end of; metres.
  double distance = kInfinity;
  /// Between two lines at a corner, of which one at least is inside the building; radians.
  double angle = kInfinity;
};

/// Over all edges of the outlines together. Precondition: parts as RoofPart states.
LineClearance line_clearance(std::span<const RoofPart> parts);

/// Without the vertices that are within a centimetre of the line between their neighbours: of
/// footprints, what only parts had.
Polygon without_junctions(const Polygon& footprint);

}  // namespace tetropolis
