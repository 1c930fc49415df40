// Roof points of clouds without a building class: what is a roof, and what hangs over it.
#pragma once

#include "tetropolis/city/extract.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"

namespace tetropolis {

/// What was found at each building; as many lists in all, in the same order.
struct CrownEvidence {
  PointLists below;   ///< Ground points inside the footprint.
  PointLists around;  ///< Points that may be roof by their class, but in no footprint: within a few
                      ///< metres of this one and not at the very wall of any.
  PointLists beside;  ///< Such points in other footprints, within two metres of this one.
};

/// From every list of points inside a footprint, removes the crowns of trees. "Neither ground nor
/// noise" is all that is known of them, and a tree over a shed is that as much as the shed's roof.
/// Only buildings with trees around are touched, more than `clearing` times as many points around
/// as roof points, 2.5 m above the lowest of these; and outlines most of whose points are ground
/// (of garages below the ground, and of what was pulled down). There, a point goes if all of this
/// holds:
/// - it hangs over others. Light passes through crowns but not through roofs. Stated as an opening
///   (Serra 1982) of points seen from above: the level around a point is the quantile `share` of
///   the heights within `radius`, ground and roofs beside included; the point is more than `height`
///   above the highest level within `radius` of it, or more than `fringe` if a crown is within
///   `radius`. Next to the edge of a roof there is a high level;
/// - it is no more than 3 m higher than the highest point around the building: trees that hang over
///   a building mostly stand beside it, towers rise above them (in outlines most of whose points
///   are ground trees need not stand beside);
/// - no more than half of the points in the ball around it lie on surfaces, which is where
///   neighbours scatter little to both sides of a plane: root of the least eigenvalue of their
///   covariance at most thickness * radius (features of Weinmann et al., "Semantic point cloud
///   interpretation based on optimal neighborhoods, relevant features and efficient classifiers",
///   ISPRS J. 105, 2015);
/// - neither do, of the points of roofs beside that are as high, within `radius` seen from above:
///   those are a higher neighbour's, and the point is on its wall.
/// A list of which less than 15 % is left, or half where a fifth of the points inside are ground,
/// loses that, too: there are trees but no building. Where more than 256 points are in a square as
/// wide as the radius, each is judged by 256 of them, evenly taken from the lists. Points stay in
/// order; the same for any number of threads. So time is proportional to the points at most.
/// Memory, for the building of each thread: some 40 bytes per point of its lists, and 16 MB at
/// most.
void drop_tree_crowns(PointLists& roof, const CrownEvidence& evidence, const PointCloud& cloud,
                      const Progress& progress = {});

}  // namespace tetropolis
