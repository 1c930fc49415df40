#include "city_parts.h"

#include <algorithm>
#include <cstdint>

namespace tetropolis {

CityParts parts_of(const CityModel& city, const MeshCityOptions& options,
                   std::span<const BuildingIndex> blocks) {
  CityParts parts;
  const bool all_blocks = solves_laplace(options);
  for (const BuildingIndex b : city.buildings.indices()) {
    const Building& building = city.buildings[b];
    const bool is_block = all_blocks || std::binary_search(blocks.begin(), blocks.end(), b);
    if (building.parts.empty() || is_block) {
      parts.outlines.push_back({&building.footprint, b, 0});
      parts.roofs.push_back({{}, building.h_roof, 0, 0});
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
