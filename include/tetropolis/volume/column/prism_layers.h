// Thin layers of prisms between open ground and the tets above it.
//
//   d ------- f
//   | \     / |    A prism (wedge): a triangle of the ground mesh at two heights, and three upright
//   |   \ /   |    quadrilaterals. It is not split into tets, which would be flat.
//   |    e    |
//   a - -|- - c    On the uppermost one columns begin: the tet mesher takes the top of the layers
//     \  |  /      for the ground.
//        b
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"

namespace tetropolis {

/// What layers are asked for.
struct LayerHeights {
  int count = 0;        ///< Layers, >= 0.
  double first = 0.5;   ///< Height of the lowest, metres, > 0.
  double growth = 1.2;  ///< From one to the next, >= 1.

  /// Of all together, metres.
  double total() const {
    double sum = 0, height = first;
    for (int i = 0; i < count; ++i, height *= growth) sum += height;
    return sum;
  }
};

/// Prisms stand in stacks, one over each triangle: `count` layers over open ground, and with
/// `whole` what would be tets, up to the top. They are numbered after all tets, stack by stack and
/// upwards.
///
/// Nodes of layers are those of each vertex from the ground upwards, without the one on top: that
/// is the lowest node of the vertex's column. Numbered after all other nodes.
struct PrismLayers {
  std::int32_t count = 0;              ///< Layers; 0: none.
  bool whole = false;                  ///< There are no tets: the columns over a triangle have as
                                       ///< many segments each, which make prisms.
  std::vector<std::int64_t> offsets;   ///< The prisms over triangle t are [offsets[t],
                                       ///< offsets[t + 1]); empty without any.
  std::vector<VertexIndex> vertices;   ///< Of open ground, ascending; none without layers.
  std::vector<std::int32_t> position;  ///< Per vertex of the ground mesh, its place in `vertices`;
                                       ///< -1: it is not there.
  std::vector<double> z;               ///< `count` elevations per vertex of `vertices`, metres,
                                       ///< increasing up to the lowest node of the column.

  std::int64_t nodes() const { return static_cast<std::int64_t>(z.size()); }
  std::int64_t cells() const { return offsets.empty() ? 0 : offsets.back(); }
};

}  // namespace tetropolis
