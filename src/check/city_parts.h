// The parts of check_city.
#pragma once

#include "tetropolis/check/check_city.h"
#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Edges that cross, and check.min_clearance. With `may_touch` only within each footprint.
void check_edge_pairs(const CityModel& city, bool may_touch, CityCheck& check);

/// What lies inside what: holes, and unless `may_touch` footprints.
void check_nesting(const CityModel& city, bool may_touch, CityCheck& check);

}  // namespace tetropolis
