// Ground lowered where prisms on it would be sheared too much.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column/edge_graph.h"

namespace tetropolis {

/// What the lowest prisms may be; others are lowered to a little less, so that the next place to be
/// looked at does not undo it. Faces between layers slope as the ground does, and lean further
/// where layers above thin out towards a wall or a ridge: by up to 24 degrees on synthetic hills.
struct PrismBounds {
  double slope_deg = 45;           ///< Of ground and of the top of the layers, > 0.
  double non_orthogonal_deg = 58;  ///< Of upright faces between two of them.
  double skewness = 1.9;           ///< Of upright faces, also those at walls and sides.
};

/// Lowers `ground` (elevation per vertex of the top of layers of prisms, metres) around triangles
/// outside buildings and their edges until prisms of the lowest layer are within the bounds, by
/// bringing the highest of the vertices at the triangle or edge down to one elevation, so pits and
/// cliffs are cut back and ridges are capped. Where flat ground would be out of the bounds, too,
/// edges are left alone. `lift`: height of the layers per vertex, > 0; `first`: of the lowest of
/// them where lift is the greatest, less in proportion elsewhere. Returns the vertices that were
/// lowered, ascending. What happens at a place depends on ground as steep that is connected to it.
std::vector<VertexIndex> ease_ground(const GroundMesh& mesh, const EdgeGraph& edges,
                                     std::span<const double> lift, double first,
                                     const PrismBounds& bounds, std::vector<double>& ground);

}  // namespace tetropolis
