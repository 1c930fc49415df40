// How messages name a building. Private to src/check.
#pragma once

#include <string>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Its id; "no building" for -1; its number where the model lacks it.
inline std::string building_name(const CityModel& city, BuildingIndex building) {
  if (building < 0) return "no building";
  if (building < BuildingIndex(city.buildings.size())) return city.buildings[building].id;
  return fmt::format("number {}", building.value());
}

}  // namespace tetropolis
