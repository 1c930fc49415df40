// The volume mesh as plain arrays, for callers that need them: nodes, cells and regions in the
// order of write_vtu. A mesh is read part by part where the arrays of all would be too large.
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

}  // namespace tetropolis
