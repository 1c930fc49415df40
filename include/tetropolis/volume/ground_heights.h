// Ground elevations of the mesh's vertices, reconciled with the roofs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Per vertex: the building it belongs to (inside its footprint or on its outline), or kNoBuilding.
/// Throws Error(kGuarantee) naming the vertex if two buildings share it: simplification keeps
/// footprints apart.
std::vector<BuildingIndex> vertex_buildings(const GroundMesh& mesh);

struct GroundHeights {
  std::vector<double> z;     ///< Per vertex, metres.
  std::int64_t lowered = 0;  ///< Vertices on walls where z is below the DTM.
};

/// z = DTM, except at vertices of a building whose roof is less than `minimum_wall` above the DTM
/// there (a building set into a slope): these get roof - wall[v], so that every wall has a positive
/// height (guarantee 4) and, where the ground has to be lowered anyway, one that cells fit.
/// `building` as from vertex_buildings; `roofs`: elevation per building; minimum_wall > 0, metres;
/// `wall`: per vertex, >= minimum_wall.
GroundHeights ground_heights(const GroundMesh& mesh, std::span<const BuildingIndex> building,
                             std::span<const double> roofs, const Raster& dtm, double minimum_wall,
                             std::span<const double> wall);

}  // namespace tetropolis
