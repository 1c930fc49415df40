// The symmetric difference of two nearly equal regions, from the edges that their outlines do not
// share.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// An edge of one of two regions, from its lower (then left) end to the upper one.
struct DifferenceEdge {
  Point2 a;
  Point2 b;
  bool of_after = false;       ///< Which of the two regions it bounds.
  bool interior_left = false;  ///< That region is on the left of a to b.
};

/// A part of the symmetric difference: what is between two edges, cut off by two parallel lines.
struct DifferenceStrip {
  std::array<Point2, 4> corners;  ///< In order around.
  DifferenceEdge left;
  DifferenceEdge right;
  bool in_after;  ///< It is in the region `after` (and then not in `before`), or the other way
                  ///< round.
};

/// Area of what is in exactly one of the regions `before` and `after`, in square steps; each is a
/// list of valid polygons with disjoint interiors, in steps, outer rings counter-clockwise and
/// holes clockwise. Edges that both share cancel; the rest fall into connected pieces, each of
/// which bounds, by the even-odd rule and with the pieces that lie inside it, a part of the
/// difference. The time is near-linear in the number of edges where the regions differ in many
/// small places. If asked for, `strips` gets the parts the area is made of.
double symmetric_difference_area(std::span<const Polygon> before, std::span<const Polygon> after,
                                 std::vector<DifferenceStrip>* strips = nullptr);

}  // namespace tetropolis
