#include "tetropolis/city/raise_roofs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tetropolis/city/roof_summary.h"

namespace tetropolis {

namespace {

/// By which h_roof has been raised already.
void raise_parts(Building& building, double by) {
  constexpr double kLeast = 2.5;  // metres
  const double floor = building.h_ground + std::min(kLeast, building.h_roof - building.h_ground);
  for (RoofPart& part : building.parts) {
    const double most = std::min(0.0, floor - range_of(part).low);
    part.roof.elevation = snap_height(part.roof.elevation + std::max(by, most));
  }
}

}  // namespace

void raise_roof(Building& building, double by) {
  building.h_roof += by;
  raise_parts(building, by);
}

std::vector<double> roof_heights(const CityModel& city) {
  std::vector<double> heights;
  for (const Building& building : city.buildings) heights.push_back(building.h_roof);
  return heights;
}

void follow_roof_heights(CityModel& city, std::vector<double>& before) {
  for (std::size_t b = 0; b < city.buildings.size(); ++b) {
    const double by = city.buildings[b].h_roof - before[b];
    if (by == 0 || !std::isfinite(by)) continue;
    raise_parts(city.buildings[b], by);
    before[b] = city.buildings[b].h_roof;
  }
}

}  // namespace tetropolis
