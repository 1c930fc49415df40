// Vertices of parts at which walls would not be a manifold. Private to src/city.
#pragma once

#include <cstdint>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Around a vertex where four parts or more meet, or three at the outline, roofs may rise and fall
/// twice: the vertical line between the lower and the higher ones would have four walls (val3dity's
/// 303). There the corner of a lower or a higher part steps back by the clearance or a little more,
/// and its two neighbours meet along a line of that length; without room for that, two of
/// the parts become one. Done where part_defects stays silent; returns how
/// many such vertices are left.
std::int64_t separate_valleys(Building& building, double clearance, double min_area);

}  // namespace tetropolis
