// Degrees, in which angles are asked for and reported, and radians, in which they are computed
// with.
#pragma once

#include <numbers>

namespace tetropolis {

constexpr double to_radians(double degrees) { return degrees * (std::numbers::pi / 180); }
constexpr double to_degrees(double radians) { return radians * (180 / std::numbers::pi); }

}  // namespace tetropolis
