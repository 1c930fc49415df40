// The patches of the boundary.
#pragma once

#include <cstdint>

namespace tetropolis {

/// What a boundary face belongs to. The numbers are those written to files.
enum class Patch : std::int32_t {
  kGround = 1,
  kRoof = 2,
  kWall = 3,
  kTop = 4,
  kXMin = 5,
  kXMax = 6,
  kYMin = 7,
  kYMax = 8,
};

}  // namespace tetropolis
