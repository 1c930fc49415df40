// The front that climbs from the lid to the top, as several threads have it climb.
//
// What a column does depends on those around it only, and on which of them have moved before. So a
// column may go as soon as all around it are to go later, whatever is going on elsewhere, and all
// is as if one thread had taken them in order. The ground is divided into tiles, one thread to
// each, which are as small as fits a cache: columns beside another tile stay, and so do those that
// wait for them; tiles across the seams are next, and those across their seams. What is left then,
// if anything, is done in one piece.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// A node by its column and its place there: 0 is on the lid.
struct FrontNode {
  VertexIndex vertex;
  std::int32_t nth;
};

/// What a column does: it rises, or ends and leaves its hole to cells under new triangles. Its
/// cells have the column's node in common and are told by their others.
struct FrontStep {
  double to;                  ///< Elevation; not a number if it ends.
  FrontNode node;             ///< Where it is.
  std::int32_t around;        ///< How many triangles of the front there are.
  std::int32_t cells_before;  ///< In its column.
  std::size_t others;         ///< Where in FrontSteps::others its own begin.

  bool is_end() const { return std::isnan(to); }
  /// How many cells it makes.
  std::int32_t cells() const { return is_end() ? around - 2 : around; }
};

/// A cell on the stack over a triangle.
struct CoveredTriangle {
  TriangleIndex triangle;
  VertexIndex vertex;  ///< Its column has made the cell,
  std::int32_t nth;    ///< after so many others.
};

/// Each column's steps are in order.
struct FrontSteps {
  std::vector<FrontStep> steps;
  /// Of a step that rises: the around + 1 nodes around it, counter-clockwise, of which the last is
  /// the first again unless it is at the rim. Of one that ends, three for each cell.
  std::vector<FrontNode> others;
  std::vector<CoveredTriangle> covered;
  /// Vertices at which cells came below the floor, and those beside them.
  std::vector<VertexIndex> poor;
};

/// `shares`: per vertex, of the spacing that segments are to have. See grow_upper(). `tiles`: along
/// the longer side of the ground, >= 1; the steps are the same for any number.
std::vector<FrontSteps> climb_to_top(const ColumnMesh& mesh, double top,
                                     std::span<const double> shares, std::size_t tiles);

/// How many are worth while.
std::size_t useful_tiles(const ColumnMesh& mesh);

}  // namespace tetropolis
