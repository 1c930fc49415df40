// Footprints for tests.
#pragma once

#include "tetropolis/geometry/types.h"

namespace tetropolis::testing {

inline Polygon rectangle(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}};
}

}  // namespace tetropolis::testing
