// The cells above the columns: from the surface that columns end at, the lid, to the top.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/ground_mesh.h"

namespace tetropolis {

using NodeIndex = Index<struct NodeTag, std::int64_t>;
using CellIndex = Index<struct CellTag, std::int64_t>;

inline constexpr CellIndex kNoCell{-1};

/// Tets over the lid of a column mesh, over which fewer and fewer columns go on. Its nodes and
/// cells are numbered after those of the columns. Empty where the lid is the top.
struct UpperMesh {
  std::vector<Point3> points;       ///< Local frame, metres.
  std::vector<VertexIndex> vertex;  ///< Per point, that of the ground mesh below it.
  /// Nodes of the mesh: (p1 - p0) x (p2 - p0) . (p3 - p0) > 0.
  std::vector<std::array<NodeIndex, 4>> cells;
  std::vector<CellIndex> over_lid;  ///< Per triangle of the ground mesh: the upper part's cell on
                                    ///< top of its stack, or kNoCell.

  bool empty() const { return cells.empty(); }
};

}  // namespace tetropolis
