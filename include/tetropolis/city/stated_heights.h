// Marks of buildings and features that rest on what the input states instead of what it measures,
// beside BuildingFlag and DropCause.
#pragma once

#include <cstdint>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// More bits of Building::flags.
inline constexpr std::uint32_t kRoofFromFloors = 1U << 9;  ///< Height from a number of floors.
inline constexpr std::uint32_t kDefaultHeight = 1U << 10;  ///< Nothing stated: the default height.

/// More causes: below ground or not built, by attributes or because ground was measured in it; and
/// an outline for which its parts stand. Their names are "no_building" and "outlined".
inline constexpr DropCause kNotABuilding{5}, kOutlined{6};

}  // namespace tetropolis
