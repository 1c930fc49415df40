#include "tetropolis/city/raise_roofs.h"

#include <cmath>
#include <cstddef>

namespace tetropolis {

namespace {

void raise_parts(Building& building, double by) {
  for (RoofPart& part : building.parts) part.roof.elevation = snap_height(part.roof.elevation + by);
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
