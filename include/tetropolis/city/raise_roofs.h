// Edits of heights, for buildings whose roofs are in parts.
#pragma once

#include <vector>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Raises h_roof and the roofs of all parts by so many metres (parts: to the millimetre). None is
/// lowered to less than 2.5 m above the ground, or h_roof if that is less.
void raise_roof(Building& building, double by);

/// The h_roof of every building, in order.
std::vector<double> roof_heights(const CityModel& city);

/// After edits of h_roof alone: raises the parts' roofs by what each h_roof has changed since
/// `before`, as raise_roof does; that becomes what it is now. What is not finite, or was not, is
/// left as it is. Precondition: `before` has one element per building.
void follow_roof_heights(CityModel& city, std::vector<double>& before);

}  // namespace tetropolis
