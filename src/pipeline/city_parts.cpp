#include "city_parts.h"

#include <cstdint>

namespace tetropolis {

CityParts parts_of(const CityModel& city, const MeshCityOptions& options) {
  CityParts parts;
  const bool blocks = solves_laplace(options);
  for (const BuildingIndex b : city.buildings.indices()) {
    const Building& building = city.buildings[b];
    if (building.parts.empty() || blocks) {
      parts.outlines.push_back({&building.footprint, b, 0});
      parts.roofs.push_back({{}, building.h_roof, 0, 0});
      parts.blocks += building.parts.empty() ? 0 : 1;
      continue;
    }
    std::int32_t number = 0;
    for (const RoofPart& part : building.parts) {
      parts.outlines.push_back({&part.outline, b, number++});
      parts.roofs.push_back(part.roof);
    }
  }
  return parts;
}

}  // namespace tetropolis
