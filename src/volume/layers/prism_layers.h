// Layers of prisms between open ground and the floor of the tets.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/column/edge_graph.h"
#include "tetropolis/volume/column/prism_layers.h"

#include "volume/column/roof_heights.h"

namespace tetropolis {

/// Height of all layers together at each vertex, metres, > 0: heights.total(), less at low walls
/// and, so that prisms are not sheared, around these: it changes by a quarter of the distance at
/// most. `terrain`: elevation per vertex; `lowest_roof`: as from lowest_roofs. Walls that are lower
/// than `minimum_wall` count as that: the ground will be lowered there. `left`: see
/// layers_beside_wall. Empty without layers.
std::vector<double> layer_lift(const GroundMesh& mesh, const EdgeGraph& edges,
                               std::span<const double> terrain,
                               std::span<const RegionIndex> lowest_roof, const RoofHeights& roofs,
                               const LayerHeights& heights, double minimum_wall, double left = 1);

/// Puts the layers, which are lift[v] high, below the columns of open ground: their lowest nodes
/// are on top of them. The lowest layer is as high as asked for as long as the ratio of one to the
/// next is between 1 / heights.growth and heights.growth; where there is no room for that, all are
/// alike. Precondition: `lift` as from layer_lift with the same `heights`, heights.count > 0,
/// heights.growth >= 1.
void lay_prisms(std::span<const double> lift, const LayerHeights& heights, ColumnMesh& mesh);

/// Makes what would be tets of the columns prisms, too. Throws Error(kGuarantee) unless the columns
/// over each triangle have as many segments each (columns_of_layers) and there is no upper part.
void make_whole(ColumnMesh& mesh);

}  // namespace tetropolis
