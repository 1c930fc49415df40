// How far two nearly equal regions are from each other.
#pragma once

#include <span>

#include "tetropolis/geometry/types.h"

#include "changed_area.h"

namespace tetropolis {

/// The point of one region that is farthest from the other one.
struct FarPoint {
  double distance = 0;
  Point2 at;
};

/// The Hausdorff distance of the regions: the largest distance from a point of either to the other,
/// in steps, too low by at most `tolerance` and too high by at most a step. Nothing is farthest
/// from an empty region: the distance is 0 then. The regions and `strips`, which cover what differs
/// between them and may cover more, are as in changed_area.h.
/// Branch and bound over parts of strips, cut at walls or in the middle: the distance to one
/// straight edge is convex, so it is largest at a corner, and the distance to the whole region is
/// no larger.
FarPoint largest_distance(std::span<const Polygon> before, std::span<const Polygon> after,
                          std::span<const DifferenceStrip> strips, double tolerance);

}  // namespace tetropolis
