// Slots between walls that are too narrow for a flow and lead nowhere.
#pragma once

#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// What fills the gaps of a polygon that are narrower than `width` and end: slots that are open at
/// one side only, and courtyards that are so narrow everywhere. Passages, open at both ends, stay.
/// Coordinates and width are steps (grid_geometry.h). Fills overlap the polygon by a few steps, so
/// that a union has no cracks. A slot is where the closing of the polygon by a square-cornered
/// offset of half the width (Serra, 1982, "Image Analysis and Mathematical Morphology") adds area.
std::vector<Polygon> dead_end_fills(const Polygon& polygon, double width);

}  // namespace tetropolis
