// What the checks of written files return. They share no code with what made the files: topology is
// derived anew from the cells, geometry from the coordinates.
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
