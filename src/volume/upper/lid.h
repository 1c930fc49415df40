// Where columns end and the upper part begins.
#pragma once

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column/edge_graph.h"

#include "volume/column/fill_columns.h"

namespace tetropolis {

/// Lowers the tops of a plan to a lid: twice the spacing above the highest floor at each vertex,
/// and no steeper than 0.6 where there are higher ones nearby. Where less than the spacing is left
/// to the top, columns go on to that, and around such places the lid falls with a slope of 1. So
/// what a roof does to the lid ends within its height over 0.6 around it.
void lower_tops(const GroundMesh& mesh, const EdgeGraph& edges, ColumnPlan& plan);

}  // namespace tetropolis
