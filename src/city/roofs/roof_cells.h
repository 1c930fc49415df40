// A building's footprint in small triangles, to be labelled with regions. Private to src/city.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/core/ragged_array.h"
#include "tetropolis/ground/triangulation.h"

#include "city/roofs/roof_input.h"

namespace tetropolis {

/// Index of a triangle of RoofCells; negative: outside.
using CellNumber = std::int32_t;

/// Of an array, for the numbers of cells, members and regions.
inline std::size_t index(std::int32_t number) { return static_cast<std::size_t>(number); }

struct RoofCells {
  Triangulation mesh;
  std::vector<std::array<CellNumber, 3>> neighbours;  ///< Per cell: across edge i of it.
  std::vector<MemberNumber> member;                   ///< Per cell: whose it is.
  RaggedArray<std::uint32_t> points;  ///< Per cell: its member's points in it, as indices of
                                      ///< RoofInput::points.values.

  std::size_t size() const { return mesh.triangles.size(); }
  /// Per member: its cells, ascending.
  std::vector<std::vector<CellNumber>> of_members(std::size_t members) const;
  Point2 vertex(CellNumber c, std::size_t i) const {
    return mesh.points[mesh.triangles[static_cast<std::size_t>(c)][i % 3]];
  }
  Point2 centre(CellNumber c) const;
  double area(CellNumber c) const;
  double edge_length(CellNumber c, std::size_t edge) const;
};

/// Triangles of about `size` metres (larger in very large buildings) along the footprint's main
/// direction; infinity: as few as there can be. Each piece that lies in no member goes to the one
/// with the longest border to it.
RoofCells make_roof_cells(const RoofInput& input, double size);

}  // namespace tetropolis
