// The cells above the columns: from the surface that columns end at, the lid, to the top.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/core/buffer.h"
#include "tetropolis/ground/ground_mesh.h"

namespace tetropolis {

using NodeIndex = Index<struct NodeTag, std::int64_t>;
using CellIndex = Index<struct CellTag, std::int64_t>;

inline constexpr CellIndex kNoCell{-1};

/// Numbers the ends of columns, by vertex, and after them the nodes of the upper part: in the order
/// of NodeIndex, which upper_node() and upper_place() change it to and from.
using UpperPlace = Index<struct UpperPlaceTag, std::int32_t>;

/// The cells around a node, when a column goes on from it or ends at it.
struct UpperFan {
  UpperPlace node;
  UpperPlace up;        ///< Where the column goes on to; UpperPlace::none() where it ends.
  std::uint32_t cell;   ///< Its first cell,
  std::uint32_t other;  ///< and its first of UpperMesh::others.
};

/// Tets over the lid of a column mesh, over which fewer and fewer columns go on. Its nodes and
/// cells are numbered after those of the columns, column by column and upwards. Empty where the lid
/// is the top. Takes about 10 bytes per cell.
struct UpperMesh {
  /// Cells in a block.
  static constexpr std::size_t kBlock = 64;
  using Cell = std::array<UpperPlace, 4>;

  Buffer<double> z;            ///< Per node: elevation.
  Buffer<VertexIndex> vertex;  ///< Per node, that of the ground mesh below it.
  Buffer<UpperFan> fans;       ///< By cells, and one more that is not there.
  /// Of a fan that goes up: what is around it, counter-clockwise, one more than it has cells: each
  /// is between two that follow each other. Of one that ends: three for each cell, which is under
  /// them.
  Buffer<UpperPlace> others;
  std::vector<std::uint32_t> fan_of_block;  ///< Which one has the first cell of each block.
  std::vector<CellIndex> over_lid;          ///< Per triangle of the ground mesh: the upper part's
                                            ///< cell on top of its stack, or kNoCell.

  bool empty() const { return fans.empty(); }
  std::size_t nodes() const { return z.size(); }
  std::size_t cells() const { return empty() ? 0 : fans.back().cell; }
  /// (p1 - p0) x (p2 - p0) . (p3 - p0) > 0. Precondition: the cell is one of fan f.
  Cell cell(std::size_t f, std::size_t cell) const {
    const UpperFan& fan = fans[f];
    const std::size_t k = cell - fan.cell;
    const UpperPlace* const other = others.data() + fan.other;
    if (fan.up.valid()) return {fan.node, other[k], other[k + 1], fan.up};
    return {fan.node, other[3 * k], other[3 * k + 1], other[3 * k + 2]};
  }
  /// Calls visit(cell) for [begin, end).
  template <typename Visit>
  void for_each_cell(std::size_t begin, std::size_t end, const Visit& visit) const {
    if (begin >= end) return;
    for (std::size_t c = begin, f = fan_of_block[begin / kBlock]; c < end; ++c) {
      while (fans[f + 1].cell <= c) ++f;
      visit(cell(f, c));
    }
  }
};

}  // namespace tetropolis
