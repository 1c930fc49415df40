// The value above all others, and none.
#pragma once

#include <limits>

namespace tetropolis {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace tetropolis
