#include "footprint_grid.h"

#include <cstddef>
#include <vector>

namespace tetropolis {

namespace {

FiledSquares file_footprints(const CityModel& city) {
  std::vector<Bounds2> boxes;
  Bounds2 all = Bounds2::nothing();
  for (const Building& building : city.buildings) {
    Bounds2& box = boxes.emplace_back(Bounds2::nothing());
    for (const Point2 p : building.footprint.outer) box.extend(p);
    all.extend(box);
  }
  return file_under_squares(boxes.size(), all,
                            [&](const Squares& squares, std::size_t b, const auto& use) {
                              if (!boxes[b].empty()) squares.for_each_in(boxes[b], use);
                            });
}

}  // namespace

bool inside(const Polygon& polygon, double x, double y) {
  bool odd = false;
  const auto cross = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
      if ((a.y <= y) != (b.y <= y) && x < a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y)) odd = !odd;
    }
  };
  cross(polygon.outer);
  for (const Ring& hole : polygon.holes) cross(hole);
  return odd;
}

FootprintGrid::FootprintGrid(const CityModel& city) : city_(city), filed_(file_footprints(city)) {}

BuildingIndex FootprintGrid::at(double x, double y) const {
  for (const std::uint32_t b : near(x, y))
    if (inside(city_.buildings[b].footprint, x, y)) return static_cast<BuildingIndex>(b);
  return kNoBuilding;
}

}  // namespace tetropolis
