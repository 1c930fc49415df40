// The value above all others.
#pragma once

#include <limits>

namespace tetropolis {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace tetropolis
