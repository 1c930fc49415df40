// The cells above the lid as a page stores them: the steps of the front that has made them
// (src/volume/upper), from which viewer/src/mesh/upper.ts has it climb again. Private to
// src/io/page.
//
// A column of the front rises by a segment, which makes a cell over each triangle around its node;
// or it ends, and triangles over its hole make one cell each. A cell depends on what has been
// around its column at that step, so steps of columns beside each other have to be taken in the
// mesh's order; others in any. The reader sorts them by keys that it makes up: twice the elevation
// of the segment's middle, and of a step that ends that of nine tenths of the segment below it
// higher. What a step has to wait longer than that is told, mostly nothing; of those that are due
// together the one with the lower vertex goes first.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Column by column, upwards. Lengths in page_steps().
struct PageUpper {
  std::vector<std::int32_t> count;  ///< Per vertex: twice the nodes above the lid, and one more if
                                    ///< the column ends; less that of the one before.
  std::vector<std::int32_t> rise;   ///< Per node: elevation less what even segments give; of the
                                    ///< last less the last of the column before that goes so far.
  std::vector<std::int32_t> wait;   ///< Per step: in eighths, rounded down, of what its key is
                                    ///< above twice the elevation of its node, or in page_steps().
  /// Per step that ends, as they are taken: how the hole is covered. Its corners count from the
  /// vertex with the lowest number on, counter-clockwise. On the chord from the last to the first,
  /// and then on those of the two parts that are left, the first part first, stands a triangle:
  /// how many corners its third one is from the chord's lower end, less 1, if there is a choice.
  std::vector<std::uint8_t> splits;
};

/// `z`: per node of columns the elevation that the reader has.
PageUpper page_upper(const ColumnMesh& mesh, std::span<const double> z);

}  // namespace tetropolis
