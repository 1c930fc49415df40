// Trees and parked cars of the synthetic block city.
#pragma once

#include "scan.h"
#include "seeded_random.h"
#include "street_plan.h"

namespace tetropolis {

/// Fills scene.trees and scene.cars: trees in parks, yards and gardens, along avenues, streets and
/// the river and on the margin; cars along the streets. Crowns keep off buildings and water.
/// Precondition: the scene's terrain, buildings and bridges are set.
void plant_and_park(const StreetPlan& plan, SeededRandom& random, SyntheticScene& scene);

}  // namespace tetropolis
