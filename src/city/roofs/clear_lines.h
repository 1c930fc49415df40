// Joint clearance of all lines of a roof. Private to src/city.
#pragma once

#include <vector>

#include "tetropolis/geometry/types.h"

#include "city/roofs/partition.h"
#include "city/roofs/region_points.h"
#include "core/infinity.h"

namespace tetropolis {

/// By so much rounding the coordinates of cleared lines may bring them closer, or make regions
/// smaller: to be asked for in addition. Metres, square metres.
inline constexpr double kForRounding = 5e-4;

struct ClearLinesOptions {
  double clearance = 1;          ///< Metres, > 0.
  double min_area = 2;           ///< Square metres: smaller regions go to a neighbour.
  double min_angle = 20;         ///< Degrees, between lines that meet.
  double most_cost = kInfinity;  ///< Nothing that costs more is done.
  bool polish = true;  ///< Move nodes to where lines fit better, in the end. Not party walls:
                       ///< what stands beside them is no reason to move them.
};

/// Moves, joins and removes lines where they come too close, each time in the way that costs least
/// (RegionPoints). Guarantees: no node is nearer than the clearance to another, or to an edge it
/// does not belong to, and no two edges meet at less than the angle (corners of the polygon and its
/// sides among themselves aside: that is for the outline); no region is smaller than min_area,
/// unless it is the only one; every region is connected. Ends: after a number of rounds only
/// operations are left that take away a node, an edge or a region. Returns where something is too
/// close still because of most_cost: then the guarantees do not hold.
std::vector<Point2> clear_lines(Partition& lines, RegionPoints& points,
                                const ClearLinesOptions& options);

}  // namespace tetropolis
