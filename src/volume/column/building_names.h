// Names of buildings for formats that are particular about them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

inline constexpr std::size_t kPrefix = 5;  ///< Of "roof_", "wall_", "over_".

/// The ids of buildings, distinct, with kPrefix characters before them at most 32 long, of letters,
/// digits, '_' and '-': other characters become '_', and one that is too long or not unique ends
/// with '.' and the building's number.
std::vector<std::string> plain_names(std::span<const Building> buildings);

}  // namespace tetropolis
