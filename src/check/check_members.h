// Whether the buildings of a merged city model are made of the features that they name.
#pragma once

#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Guarantee 1: of every source id of a building of `city`, a footprint that has it in `raw` comes
/// within `reach` of the building's footprint, or overlaps it. Ids that `raw` has not are passed
/// over. Both models in one local frame, metres; `reach` is the largest distance that merging has
/// moved an outline.
std::vector<Violation> check_members(const CityModel& raw, const CityModel& city, double reach);

}  // namespace tetropolis
