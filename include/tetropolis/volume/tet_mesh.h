// A mesh of tets and prisms as explicit lists: what is read back from files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetropolis {

struct TetMesh {
  std::vector<std::array<double, 3>> points;       ///< In the frame of the file, metres.
  std::vector<std::array<std::int64_t, 4>> cells;  ///< (p1 - p0) x (p2 - p0) . (p3 - p0) > 0.
  std::vector<std::int32_t> region;  ///< Per cell, tets first, as in write_vtu; may be empty.
  /// A triangle and the one above it: (p1 - p0) x (p2 - p0) . (p3 - p0) > 0.
  std::vector<std::array<std::int64_t, 6>> wedges = {};

  std::size_t cell_count() const { return cells.size() + wedges.size(); }
};

}  // namespace tetropolis
