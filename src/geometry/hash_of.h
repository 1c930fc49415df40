// A hash of a place. Private to the library.
#pragma once

#include <bit>
#include <cstdint>

#include "tetropolis/geometry/types.h"

#include "core/mix64.h"

namespace tetropolis {

/// What to order or toss coins by where numbers would depend on far places: well mixed, and the
/// same for the same coordinates.
inline std::uint64_t hash_of(Point2 p) {
  return mix64(mix64(std::bit_cast<std::uint64_t>(p.y)) ^ std::bit_cast<std::uint64_t>(p.x));
}

}  // namespace tetropolis
