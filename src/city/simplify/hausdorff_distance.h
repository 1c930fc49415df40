// The Hausdorff distance between two nearly equal regions.
#pragma once

#include <span>

#include "tetropolis/geometry/types.h"

#include "symmetric_difference.h"

namespace tetropolis {

/// A distance, and the point of one region that is so far from the other one.
struct HausdorffDistance {
  double distance = 0;
  Point2 at;
};

/// The (symmetric) Hausdorff distance: the largest distance from a point of either region to the
/// other, in steps, too low by at most `tolerance` and too high by at most a step. Nothing is
/// farthest from an empty region: the distance is 0 then. The regions and `strips`, which cover
/// what differs between them and may cover more, are as in symmetric_difference.h. Branch and bound
/// over parts of strips, cut at walls or in the middle: the distance to one straight edge is
/// convex, so it is largest at a corner, and the distance to the whole region is no larger.
HausdorffDistance hausdorff_distance(std::span<const Polygon> before,
                                     std::span<const Polygon> after,
                                     std::span<const DifferenceStrip> strips, double tolerance);

}  // namespace tetropolis
