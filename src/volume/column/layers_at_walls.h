// How high layers of prisms may be beside walls, and walls above layers.
#pragma once

#include <algorithm>

namespace tetropolis {

/// Height of all layers together beside a wall, metres, so that the wall goes on above them: by
/// `left`, a metre for tets, where that leaves the layers three tenths of it, and by two fifths of
/// it at least.
inline double layers_beside_wall(double all, double wall, double left = 1) {
  constexpr double kLeast = 0.3, kMost = 0.6;
  return std::min(all, std::clamp(wall - left, kLeast * wall, kMost * wall));
}

/// The least height of a wall above `layers`, where walls are at least `minimum_wall` high; metres.
/// Those that layers_beside_wall() was made for are higher, so rounding lowers no ground.
inline double wall_above_layers(double minimum_wall, double layers) {
  constexpr double kShare = 0.6;  // two thirds are left
  return std::max(minimum_wall - layers, kShare * layers);
}

}  // namespace tetropolis
