// Footprints for tests.
#pragma once

#include <cmath>
#include <random>

#include "tetropolis/geometry/types.h"

namespace tetropolis::testing {

inline Polygon rectangle(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}};
}

/// A simple ring around `centre` with random radii in [smallest, largest].
inline Ring random_star(std::mt19937& random, Point2 centre, int vertices, double smallest,
                        double largest) {
  std::uniform_real_distribution<double> radius(smallest, largest);
  Ring ring;
  for (int k = 0; k < vertices; ++k) {
    const double angle = 2 * M_PI * k / vertices;
    const double r = radius(random);
    ring.push_back({centre.x + r * std::cos(angle), centre.y + r * std::sin(angle)});
  }
  return ring;
}

}  // namespace tetropolis::testing
