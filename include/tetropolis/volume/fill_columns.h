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

/// Per vertex, how far the ground of a neighbour (across an edge of a triangle outside buildings)
/// lies above its own at most, in metres, >= 0. `ground`: elevation per vertex.
std::vector<double> ground_rise(const GroundMesh& mesh, std::span<const double> ground);

/// What the columns are made from, per vertex of the ground mesh and in metres.
struct ColumnEnds {
  std::span<const double> ground;
  std::span<const BuildingIndex> building;  ///< As from vertex_buildings.
  std::span<const double> roofs;            ///< Elevations, per building.
  std::span<const double> top;
  std::span<const double> spacing;  ///< Distance between nodes asked for, > 0.
  std::span<const double> rise;     ///< As from ground_rise.
};

/// How many nodes each column gets, and which of them is at the roof; z has its size and no values.
/// Columns go from the ground (inside buildings: from the roof) to the top, with a node at the roof
/// where a wall stands. Each piece between two of these elevations is divided into the number of
/// segments that comes closest to the spacing, at least one. At the foot of a cliff (the spacing
/// is less than 0.6 of the rise) the first two segments are 0.6 and 0.4 of the rise instead: the
/// tets between the foot's column and the edge of the cliff would be slivers else, as atan(r) -
/// atan(r - s / d) with r = rise / d at distance d falls with r squared for a fixed spacing s.
/// Throws Error(kGuarantee) naming the vertex if the elevations do not increase.
ColumnMesh divide_columns(GroundMesh ground, EdgeGraph edges, const ColumnEnds& ends);

/// Sets z: exact at ground, roof and top. `mesh` as made by divide_columns with the same ends.
void place_nodes(ColumnMesh& mesh, const ColumnEnds& ends);

/// The nodes of a trimmed layered mesh that belong to cells, where they are.
ColumnMesh columns_of_layers(LayeredMesh&& layered);

}  // namespace tetropolis
