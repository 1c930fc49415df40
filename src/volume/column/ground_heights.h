// Ground elevations of the mesh's vertices, reconciled with the roofs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/terrain/raster.h"

#include "roof_heights.h"

namespace tetropolis {

/// Per vertex: of the building parts around it, the one with the lowest roof, or kNoRegion.
/// What holds for the wall below that roof holds for those of higher ones.
std::vector<RegionIndex> lowest_roofs(const GroundMesh& mesh, const RoofHeights& roofs);

/// Per vertex: 1 if a triangle outside buildings has it.
std::vector<std::uint8_t> outside_vertices(const GroundMesh& mesh);

/// Longest edge, in metres, that fits the wall from a to b below the plane `roof`: four
/// times its height (at least a metre), where that is least, so that cells beside a low wall are
/// not flat. Where the wall is lower than `minimum_wall`, the ground will be lowered to fit the
/// cells (lower_at_walls), and a roof below the terrain looks the steeper the nearer that is. So
/// such places do not count, and the edge is no less than three times their depth below the
/// terrain; there is no bound (infinity) if the wall has such places only, or the terrain along it
/// rises by more than one in four. Heights are looked up once per step of the DTM.
/// With layers over open ground (all of them `layers` metres high) the wall is what is above them.
double longest_wall_edge(const Raster& dtm, const RoofPlane& roof, Point2 a, Point2 b,
                         double minimum_wall, double layers = 0);

/// The DTM at each vertex; but water is level: all vertices of a piece (triangles of regions with
/// the patch "water" that have edges in common) have the median of the DTM along its rim. Where two
/// pieces meet in a corner, that has the lower one's.
std::vector<double> terrain_under(const GroundMesh& mesh, const Raster& dtm);

/// Lowers `ground` at vertices of buildings whose roof is less than least[v] above it (a building
/// set into a slope) to roof - wall[v], so that every wall has a positive height (guarantee 4) and,
/// where the ground has to be lowered anyway, one that cells fit. `lowest_roof` as
/// from lowest_roofs; `least`, `wall`: per vertex, metres, 0 < least <= wall.
void lower_at_walls(const GroundMesh& mesh, std::span<const RegionIndex> lowest_roof,
                    const RoofHeights& roofs, std::span<const double> least,
                    std::span<const double> wall, std::vector<double>& ground);

}  // namespace tetropolis
