// The front that climbs from the lid to the top, as several threads have it climb.
//
// What a column does depends on those around it only, and on which of them have moved before. So a
// column may go as soon as all around it are to go later, whatever is going on elsewhere, and all
// is as if one thread had taken them in order. The ground is divided into strips, one thread to
// each: columns beside another strip stay, and so do those that wait for them; strips across the
// seams are next; what is left then, if anything, is done in one piece.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// What a column does: it rises, or ends and leaves its hole to cells under new triangles.
struct FrontStep {
  double order;  ///< Steps are taken by `order`, vertex, and as they come.
  double to;     ///< Elevation; not a number if it ends.
  VertexIndex vertex;
  std::int32_t around;  ///< How many triangles of the front there are.
  std::size_t numbers;  ///< Where in FrontSteps::numbers its own begin.

  bool is_end() const { return std::isnan(to); }
  /// How many cells it makes.
  std::size_t cells() const { return static_cast<std::size_t>(is_end() ? around - 2 : around); }
};

struct FrontSteps {
  std::vector<FrontStep> steps;
  /// Of a step that rises: the around + 1 vertices around it, counter-clockwise, of which the last
  /// is the first again unless it is at the rim; then the `around` triangles of the ground mesh,
  /// which the front's have the numbers of. Of one that ends: the vertices of its cells, three of
  /// each; then the triangles around it, and for each of them the cell over it, from 0 on.
  std::vector<std::int32_t> numbers;
  /// Vertices at which cells came below the floor, and those beside them.
  std::vector<VertexIndex> poor;
};

/// `shares`: per vertex, of the spacing that segments are to have. See grow_upper(). The steps are
/// the same for any number of strips >= 1.
std::vector<FrontSteps> climb_to_top(const ColumnMesh& mesh, double top,
                                     std::span<const double> shares, std::size_t strips);

/// How many strips are worth while: few on small ground, and one without other threads.
std::size_t useful_strips(const ColumnMesh& mesh);

}  // namespace tetropolis
