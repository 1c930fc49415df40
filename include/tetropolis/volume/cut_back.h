// Terrain cut back around roofs that lie below it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column_mesh.h"

namespace tetropolis {

struct ColumnPlan;  // fill_columns.h

/// How steeply ground may rise where it is cut back; tangents, > 0.
struct CutSlopes {
  double at_roof = 1.4825609685127403;  ///< In the triangles at the roof's edge; 56 degrees.
  double beyond = 2.75;                 ///< Further away, if that is more; 70 degrees.
};

/// Lowers `ground` at vertices outside buildings and on walls, until it rises no more steeply than
/// `slopes` say from the roof's edge of a building with a 1 in `cut`, or from ground that was
/// lowered so (to a micrometre). Distances are those in the triangles outside buildings. Where the
/// terrain dips below that, nothing beyond is touched; a hillside steeper than `slopes.beyond` is
/// cut back to its crest. Returns the buildings from whose roofs something was lowered, ascending.
/// `ground`: elevation per vertex; `building` as from vertex_buildings; `roofs`: elevation and
/// `cut`: 0 or 1, per building.
std::vector<BuildingIndex> cut_back(const GroundMesh& mesh, std::span<const BuildingIndex> building,
                                    std::span<const double> roofs,
                                    std::span<const std::uint8_t> cut, const CutSlopes& slopes,
                                    std::vector<double>& ground);

/// Cells with a dihedral angle outside of these bounds, in degrees.
struct AngleBounds {
  double least = 0;
  double greatest = 180;
};

/// Sets `cut` to 1 for buildings beside which a cell is outside the bounds and the ground rises
/// above the roof within the triangle, outside buildings, that the cell stands over. Returns how
/// many were 0 before. `plan` is the one `mesh` was made with; `cut`: 0 or 1 per building.
std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan,
                               const AngleBounds& bounds, std::vector<std::uint8_t>& cut);

/// How many cells are outside the bounds over the triangles outside buildings that touch a building
/// with a 1 in `cut`. `building` as from vertex_buildings.
std::int64_t count_bad_cells(const ColumnMesh& mesh, std::span<const BuildingIndex> building,
                             const AngleBounds& bounds, std::span<const std::uint8_t> cut);

}  // namespace tetropolis
