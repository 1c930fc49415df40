// The volume mesh as plain arrays, for callers that need them: nodes, cells, regions and faces in
// the order of write_vtu. A mesh is read part by part where the arrays of all would be too large.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Positions of all nodes plus `shift`. Precondition: `points` has mesh.node_count() of them.
void fill_points(const ColumnMesh& mesh, const Point3& shift,
                 std::span<std::array<double, 3>> points);

/// Nodes of the tets of the rows [begin, end) of cell_offsets(), as for_each_tet_of has them.
/// Precondition: `offsets` is cell_offsets(mesh); `cells` has offsets[end] - offsets[begin].
void fill_cells(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                std::size_t end, std::span<std::array<NodeIndex, 4>> cells);

/// The building that each of these cells stands over, or kNoBuilding, as in the upper part.
/// Preconditions likewise.
void fill_regions(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                  std::size_t end, std::span<BuildingIndex> regions);

/// Nodes of all prisms, as wedge() has them. Precondition: `wedges` has mesh.layers.cells().
void fill_wedges(const ColumnMesh& mesh, std::span<std::array<NodeIndex, 6>> wedges);

/// A face between two cells: its normal (right-hand rule) leaves `owner` for `neighbour`, and
/// owner < neighbour.
struct CellFace {
  CellIndex owner, neighbour;      ///< Prisms count after all tets.
  std::array<NodeIndex, 4> nodes;  ///< The first `corners` of them.
  std::size_t corners = 3;         ///< 4 at the sides of prisms.
};

/// All faces between two cells, by owner and then by neighbour, as finite-volume programs want
/// them. Faces of one cell only are those of extract_boundary, which names it. Time and memory
/// linear in the cells.
std::vector<CellFace> internal_faces(const ColumnMesh& mesh);

}  // namespace tetropolis
