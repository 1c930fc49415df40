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

/// What a column does: it rises, or ends and leaves its hole to cells under new triangles. Its
/// cells have the column's node in common and are told by the columns of their others, at the nodes
/// where these are by then.
struct FrontStep {
  double to;  ///< Elevation; not a number if it ends.
  VertexIndex vertex;
  std::int32_t around;  ///< How many triangles of the front there are.

  bool is_end() const { return std::isnan(to); }
  /// How many cells it makes.
  std::int32_t cells() const { return is_end() ? around - 2 : around; }
  /// In FrontSteps::others.
  std::int32_t others() const { return is_end() ? 3 * cells() : around + 1; }
};

/// A cell on the stack over a triangle.
struct CoveredTriangle {
  TriangleIndex triangle;
  VertexIndex vertex;  ///< Its column has made the cell,
  std::int32_t nth;    ///< after so many others.
};

/// Those of a tile, as they are taken.
struct FrontSteps {
  std::vector<FrontStep> steps;
  /// Step by step. Of one that rises: the around + 1 columns around it, counter-clockwise, of which
  /// the last is the first again unless it is at the rim. Of one that ends, three for each cell.
  std::vector<VertexIndex> others;
  std::vector<CoveredTriangle> covered;
  /// Vertices at which cells came below the floor, and those beside them.
  std::vector<VertexIndex> poor;
};

/// `shares`: per vertex, of the spacing that segments are to have. See grow_upper(). `tiles`: along
/// the longer side of the ground, >= 1; each column's steps are the same for any number. Returns
/// the steps by phase and tile; tiles of a phase have no column in common, in steps or others.
std::vector<std::vector<FrontSteps>> climb_to_top(const ColumnMesh& mesh, double top,
                                                  std::span<const double> shares,
                                                  std::size_t tiles);

/// How many are worth while.
std::size_t useful_tiles(const ColumnMesh& mesh);

}  // namespace tetropolis
