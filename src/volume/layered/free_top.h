// The top of a domain that follows the terrain.
#pragma once

#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column/edge_graph.h"

namespace tetropolis {

/// Raises `top` (elevation per vertex of `mesh`, metres), as little as can be, until no edge of
/// `edges` is steeper than `slope` (tangent, > 0). A top that follows the terrain can be a cliff
/// where that drops at a wall by more than the air above is high; cells below one are flat whatever
/// their columns are. Cost: a logarithm per vertex that is raised.
void limit_slope(const GroundMesh& mesh, const EdgeGraph& edges, double slope,
                 std::vector<double>& top);

}  // namespace tetropolis
