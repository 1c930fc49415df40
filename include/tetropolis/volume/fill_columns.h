// From the ground mesh to the column mesh: how far apart nodes are, and where they go.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column_mesh.h"
#include "tetropolis/volume/layered_mesh.h"

namespace tetropolis {

/// Per vertex, the distance between nodes of its column, in metres, that fits the triangles around
/// it: 1.2 times the geometric mean of the longest edge at the vertex and of the edge of an
/// equilateral triangle as high as the flattest triangle there. Tets of a column are flat where
/// this is too small for the longest edge (least dihedral angle about atan(spacing / edge)) and
/// steep where it is too large for the least altitude a (about atan(a / spacing)); the mean keeps
/// both away from the extremes. The factor trades cells (fewer by its inverse) against angles:
/// docs/method.md has the figures. Precondition: every vertex belongs to a triangle.
std::vector<double> column_spacing(const GroundMesh& ground);

/// The fixed elevations of the columns, per vertex of the ground mesh and in metres.
struct ColumnEnds {
  std::span<const double> ground;
  std::span<const BuildingIndex> building;  ///< As from vertex_buildings.
  std::span<const double> roofs;            ///< Per building.
  std::span<const double> top;
};

/// How many nodes each column gets, and which of them is at the roof; z has its size and no values.
/// Columns go from the ground (inside buildings: from the roof) to the top, with a node at the roof
/// where a wall stands. Each piece between two of these elevations is divided into the number of
/// segments that comes closest to `spacing` (per vertex, metres, > 0), at least one. Throws
/// Error(kGuarantee) naming the vertex if the elevations do not increase.
ColumnMesh divide_columns(GroundMesh ground, EdgeGraph edges, const ColumnEnds& ends,
                          std::span<const double> spacing);

/// Sets z: exact at ground, roof and top, even in between. `mesh` as made by divide_columns with
/// the same ends.
void place_nodes(ColumnMesh& mesh, const ColumnEnds& ends);

/// The nodes of a trimmed layered mesh that belong to cells, where they are.
ColumnMesh columns_of_layers(LayeredMesh&& layered);

}  // namespace tetropolis
