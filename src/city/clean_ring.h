// Cleaning of single rings. Coordinates are steps (grid_geometry.h).
#pragma once

#include <cstddef>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The ring without the repeated last vertex, without vertices closer than kNearDuplicate to the
/// one before, and without spikes: vertices where the outline turns back upon itself within a step.
/// Empty if fewer than three vertices are left.
Ring without_duplicates(const Ring& ring);

/// The ring without vertices whose two edges differ in direction by less than `tolerance` (radians)
/// and that are within 2 cm of the segment that replaces them, or that go forward and are within
/// half a millimetre of it; no vertex dropped ends up further than kMaxOutlineShift from the
/// outline. Those nearest to their segment go first.
Ring without_parallels(const Ring& ring, double tolerance);

/// The number of different vertices, up to three.
std::size_t distinct_vertices(const Ring& ring);

}  // namespace tetropolis
