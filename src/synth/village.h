// The sound part of the adversarial city: plots in a turned grid, with a few buildings on each.
#pragma once

#include <vector>

#include "tetropolis/geometry/types.h"

#include "scan.h"
#include "seeded_random.h"

namespace tetropolis {

struct VillagePlot {
  Point2 centre;
  Point2 axis;      ///< Unit vector.
  double half = 0;  ///< Buildings stay within |u|, |v| <= half of the centre.
  std::vector<SyntheticBuilding> buildings;

  /// A position in the plot's frame: u along the axis, v to its left.
  Point2 at(double u, double v) const {
    return {centre.x + u * axis.x - v * axis.y, centre.y + u * axis.y + v * axis.x};
  }
  /// The same in whole millimetres.
  Point2 on_mm(double u, double v) const { return tetropolis::on_mm(at(u, v)); }
  /// A rectangle in the plot's frame, counter-clockwise, in whole millimetres.
  Ring rectangle(double west, double south, double east, double north) const;
};

/// A unit vector; made without trigonometry. `t` in [-1, 1] covers half a turn.
Point2 direction(double t);

/// Plots that stay `margin` away from the border of the square.
std::vector<VillagePlot> village(double size, double margin, SeededRandom& random);

/// Trees and cars at random places.
void furnish(SyntheticScene& scene, SeededRandom& random);

}  // namespace tetropolis
