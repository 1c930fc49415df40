// Angles are radians in code. Where they are asked for and reported they are degrees, and their
// names end in _deg (constants: Deg).
#pragma once

#include <numbers>

namespace tetropolis {

constexpr double to_radians(double degrees) { return degrees * (std::numbers::pi / 180); }
constexpr double to_degrees(double radians) { return radians * (180 / std::numbers::pi); }

}  // namespace tetropolis
