// What differs between two nearly equal regions: the parts of their symmetric difference, from the
// edges that the two outlines do not share.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// An edge of one of two regions, from its lower (then left) end to the upper one.
struct DifferenceEdge {
  Point2 a;
  Point2 b;
  bool of_after = false;  ///< Which of the two regions it bounds.
};

/// A connected piece of the boundary of the symmetric difference.
struct DifferencePiece {
  std::vector<DifferenceEdge> edges;  ///< Sorted by lower end.
  double area = 0;                    ///< What it bounds, by the even-odd rule, square steps.
  bool inside =
      false;  ///< It lies inside what others bound: its area is not part of the difference.
};

/// The pieces that bound what is in exactly one of the regions `before` and `after`; each is a list
/// of valid polygons with disjoint interiors, in steps. Edges that both share cancel; the rest
/// falls into connected pieces. The time is near-linear in the number of edges where the regions
/// differ in many small places.
std::vector<DifferencePiece> difference_pieces(std::span<const Polygon> before,
                                               std::span<const Polygon> after);

/// The area of the symmetric difference.
double changed_area(std::span<const DifferencePiece> pieces);

}  // namespace tetropolis
