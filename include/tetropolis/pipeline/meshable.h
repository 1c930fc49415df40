// What a mesh asks of a city model that build_city has not made, or that has been edited.
#pragma once

#include <string>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Moves to `city.dropped`, with a reason, the buildings that reach where no elevation is, leave
/// `city.domain`, or are closer than `min_distance` to its boundary. Returns how many features
/// these are.
std::size_t drop_unmeshable(CityModel& city, double min_distance);

/// Throws Error(kInput), naming `source` and the building, unless footprints are valid, lie in
/// `city.domain` and keep `min_distance` (metres) from each other and its boundary. Returns their
/// clearance in metres; infinity without buildings.
double require_meshable(const CityModel& city, double min_distance, const std::string& source);

}  // namespace tetropolis
