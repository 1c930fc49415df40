// Terrain cut back around roofs that lie below it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column_mesh.h"
#include "tetropolis/volume/fill_columns.h"

namespace tetropolis {

/// Lowers `ground` at vertices outside buildings and on walls until it rises nowhere more steeply
/// than `slope` (a tangent, > 0) from the roof's edge of a building with a 1 in `cut`, or from
/// ground that was lowered so. Distances are those in the triangles outside buildings. Where the
/// terrain dips below that slope, nothing beyond is touched. `ground`: elevation per vertex;
/// `building` as from vertex_buildings; `roofs`: elevation and `cut`: 0 or 1, per building.
void cut_back(const GroundMesh& mesh, std::span<const BuildingIndex> building,
              std::span<const double> roofs, std::span<const std::uint8_t> cut, double slope,
              std::vector<double>& ground);

/// Sets `cut` to 1 for buildings beside which a cell has a dihedral angle below `least_deg` or
/// above `greatest_deg` and the ground rises above the roof within the triangle, outside buildings,
/// that the cell stands over. Returns how many were 0 before. `plan` is the one `mesh` was made
/// with; `cut`: 0 or 1 per building.
std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan, double least_deg,
                               double greatest_deg, std::vector<std::uint8_t>& cut);

}  // namespace tetropolis
