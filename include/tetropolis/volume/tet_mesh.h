// A tetrahedral mesh as an explicit list: what is read back from files.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tetropolis {

struct TetMesh {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<std::int64_t, 4>> cells;  ///< (p1 - p0) x (p2 - p0) . (p3 - p0) > 0.
  std::vector<std::int32_t> region;                ///< Per cell, as in write_vtu; may be empty.
};

}  // namespace tetropolis
