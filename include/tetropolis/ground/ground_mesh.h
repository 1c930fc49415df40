// The triangle mesh of the domain in which every footprint edge is a union of mesh edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Vertices and triangles are numbered so that neighbours in the plane are near in memory.
struct GroundMesh {
  std::vector<Point2> vertices;                       ///< Local frame, metres.
  std::vector<std::array<VertexIndex, 3>> triangles;  ///< Counter-clockwise.
  std::vector<BuildingIndex> region;                  ///< Per triangle: the building whose
                                                      ///< footprint it lies in, or kNoBuilding.
  std::int64_t small_input_angles = 0;  ///< Corners of the input sharper than the minimum angle.
  /// Triangles below it: at such corners, and across from them (see refine.h).
  std::int64_t triangles_below_min_angle = 0;
};

}  // namespace tetropolis
