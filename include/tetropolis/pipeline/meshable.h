// What a mesh asks of a city model that build_city has not made, or that has been edited.
#pragma once

#include <cstddef>
#include <string>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Moves to `city.dropped`, with a reason, the buildings that reach where no elevation is, leave
/// `city.domain`, or are closer than `min_distance` to its boundary. Returns how many features
/// these are.
std::size_t drop_unmeshable(CityModel& city, double min_distance);

/// Buildings whose parts a mesh cannot have as they are.
struct FlattenedRoofs {
  std::size_t simplified = 0;    ///< Their lines were simplified until it could.
  std::string first_simplified;  ///< Building and reason.
  std::size_t count = 0;         ///< They became one block.
  std::string first;             ///< Building and reason.
};

/// Simplifies the lines of parts (those smaller than 2 m2 go to their neighbours, roofs steeper
/// than 70 degrees get these), or, where that is not enough, takes the parts, and the vertices of
/// the footprint that only parts had, from buildings where two corners of parts, or a corner and a
/// line that it is not on, are less than `min_distance` (metres) apart, where a line inside meets
/// another at less than 13 degrees, or a roof is steeper than 70 degrees.
FlattenedRoofs flatten_unmeshable(CityModel& city, double min_distance);

/// Throws Error(kInput), naming `source` and the building, unless footprints are valid, lie in
/// `city.domain` and keep `min_distance` (metres) from each other and its boundary, and parts tile
/// their footprint, keep that distance between their lines, and are above `h_ground`. Returns the
/// clearance in metres; infinity without buildings.
double require_meshable(const CityModel& city, double min_distance, const std::string& source);

}  // namespace tetropolis
