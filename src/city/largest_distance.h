// How far two nearly equal regions are from each other.
#pragma once

#include <span>

#include "tetropolis/geometry/types.h"

#include "city/changed_area.h"

namespace tetropolis {

/// The point of one region that is farthest from the other one.
struct FarPoint {
  double distance = 0;
  Point2 at;
};

/// The Hausdorff distance of the regions: the largest distance from a point of either to the other,
/// in steps, too low by at most `tolerance` (by more only where the largest distance is inside a
/// piece and below `floor`, which saves the search of many small ones). The regions and their
/// `pieces` are as in changed_area.h; both regions must have edges where there are pieces. Branch
/// and bound: along the edges of the pieces, where the largest distance to one straight edge is at
/// an end of any segment (it is a convex function); inside pieces, which matters for filled
/// courtyards, by quartering squares.
FarPoint largest_distance(std::span<const Polygon> before, std::span<const Polygon> after,
                          std::span<const DifferencePiece> pieces, double tolerance, double floor);

}  // namespace tetropolis
