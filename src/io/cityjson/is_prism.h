// Whether the solid of a building is what its footprint and heights make. Private to src/io.
#pragma once

#include <vector>

#include "tetropolis/city/city_model.h"

#include "body_footprint.h"

namespace tetropolis {

/// Whether the faces close a body with their fronts outwards, whose corners are those of the
/// footprint at `h_ground` and at `h_roof` (where semantics say ground or roof, at that one) and
/// whose volume is that of the prism: to a centimetre, as other programs round coordinates.
/// Precondition: the footprint is not empty.
bool is_prism(const std::vector<Face>& faces, const Building& building);

/// The same of a building with parts: whether the faces close a body with their fronts outwards,
/// whose ground is at `h_ground` and whose volume is that below the roofs, to a centimetre.
/// Precondition: the roofs' corners are on their planes.
bool is_roofed(const std::vector<Face>& faces, const Building& building);

}  // namespace tetropolis
