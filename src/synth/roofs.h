// Roofs of synthetic buildings, in parts with known planes.
#pragma once

#include <vector>

#include "tetropolis/city/city_model.h"

#include "scan.h"
#include "seeded_random.h"

namespace tetropolis {

/// A roof over a building that is `ground` metres high at its interior point: gables, hips, sheds,
/// mansards, half-roofs with a step between them, dormers and towers, on each convex piece of the
/// footprint. Parts are as RoofPart says (vertices in whole millimetres, no points), but for the
/// footprint, which lacks their corners. None: the roof is level at ground + height.
std::vector<RoofPart> build_roof(const SyntheticBuilding& building, double ground,
                                 SeededRandom& random);

}  // namespace tetropolis
