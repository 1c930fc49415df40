// Step 1.4: one footprint as it comes from a file becomes a valid polygon, or a reason why not.
#pragma once

#include <string>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct CleanOptions {
  double parallel_tolerance = 0.01;  ///< Radians; edges closer in direction count as parallel.
};

/// Vertices closer to their predecessor than this are duplicates. Metres.
inline constexpr double kNearDuplicate = 0.001;

/// Removing vertices between parallel edges moves the outline by no more than this, and by no more
/// than 2 cm at one vertex. Metres.
inline constexpr double kMaxOutlineShift = 0.05;

struct CleanedFootprint {
  Polygon polygon;        ///< Empty where `reason` is not.
  bool repaired = false;  ///< The rings were invalid and have been repaired.
  double lost_area = 0;   ///< Of the parts that the repair gave up, square metres.
  std::string reason;     ///< Why the footprint is unusable (a short clause), or empty.
  bool usable() const { return reason.empty(); }
};

/// Cleans one footprint. Any rings: open or closed (first vertex repeated), of any orientation,
/// self-intersecting, with NaN or huge coordinates. Never throws for bad geometry.
/// Guarantees for usable results (footprint_defects is empty): coordinates on the grid of
/// kCoordinateStep; outer ring counter-clockwise, holes clockwise, inside it and disjoint; rings
/// simple, nowhere touching themselves or each other; no vertices closer than kNearDuplicate along
/// a ring, no spikes of zero width; where possible within kMaxOutlineShift, no consecutive edges
/// whose directions differ by less than parallel_tolerance.
/// Invalid rings become what they enclose; of several parts that touch, the touching corners are
/// joined by a bridge of some centimetres, of parts that do not, the largest is kept and the area
/// of the others told. Holes that leave nothing of the shell are ignored.
/// Cleaning a result again mostly changes nothing, but may: kMaxOutlineShift counts from the
/// outline given, so that where vertices were kept only because of it, some may go, again within
/// it.
CleanedFootprint clean_footprint(const Polygon& raw, const CleanOptions& options = {});

}  // namespace tetropolis
