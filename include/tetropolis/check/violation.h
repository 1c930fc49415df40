// What the checks of written files return. Topology is derived anew from the cells, geometry from
// the coordinates. With what made the files the checks share only plain types, parallel loops,
// ragged arrays and errors (core), elementary geometry of footprints (geometry/), the angles of the
// ground mesh (check_angles in ground/validate.h), a check itself, and what the guarantees are
// measured by: the step of coordinates (kCoordinateStep), the rounding that a clearance may lose
// (is_clear), the slopes of cuts (volume/excavate/excavate.h) and what `mesh` makes blocks of
// (flatten_unmeshable). The files are read by the readers of io.
#pragma once

#include <cstdint>
#include <string>

namespace tetropolis {

/// A guarantee that does not hold: how often, and the first place.
struct Violation {
  std::string what;  ///< Short clause, such as "inverted cells".
  std::int64_t count = 0;
  std::string first;  ///< Where it was seen first ("cell 17 at (1.0, 2.0, 3.0)").
};

}  // namespace tetropolis
