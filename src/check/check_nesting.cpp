#include <cstddef>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "city_parts.h"
#include "footprint_grid.h"
#include "segment_distance.h"
#include "violations.h"

namespace tetropolis {

namespace {

/// 1 inside the ring, -1 outside, 0 where it is not further from an edge than coordinates are from
/// each other: raw footprints may touch themselves.
int side_of(const Ring& ring, Point2 p) {
  bool odd = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
    if (segment_distance(p, a, b) <= kCoordinateStep) return 0;
    if ((a.y <= p.y) != (b.y <= p.y) && p.x - a.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y))
      odd = !odd;
  }
  return odd ? 1 : -1;
}

int side_of(const Polygon& polygon, Point2 p) {
  const int of_outer = side_of(polygon.outer, p);
  if (of_outer <= 0) return of_outer;
  for (const Ring& hole : polygon.holes)
    if (const int of_hole = side_of(hole, p); of_hole >= 0) return -of_hole;
  return 1;
}

/// On which side of `shape` a ring lies that does not cross it: where it does not touch.
template <typename Shape>
int side_of(const Shape& shape, const Ring& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
    for (const Point2 p : {a, Point2{(a.x + b.x) / 2, (a.y + b.y) / 2}})
      if (const int side = side_of(shape, p); side != 0) return side;
  }
  return 0;
}

void check_holes(const Building& building, std::vector<Violation>& violations) {
  const Polygon& polygon = building.footprint;
  const auto place = [&] { return "building " + building.id; };
  std::vector<Bounds2> boxes;
  for (const Ring& hole : polygon.holes) {
    boxes.push_back(bounds(hole));
    if (side_of(polygon.outer, hole) < 0)
      note_violation(violations, "holes outside their footprint", place);
  }
  for (std::size_t h = 0; h < boxes.size(); ++h)
    for (std::size_t g = 0; g < boxes.size(); ++g)
      if (h != g && boxes[g].covers(boxes[h]) && side_of(polygon.holes[g], polygon.holes[h]) > 0)
        note_violation(violations, "holes inside one another", place);
}

}  // namespace

void check_nesting(const CityModel& city, bool may_touch, CityCheck& check) {
  const FootprintGrid footprints(city);
  const auto look = [&](std::size_t begin, std::size_t end, std::vector<Violation>& violations) {
    for (std::size_t a = begin; a < end; ++a) {
      const Building& building = city.buildings[a];
      check_holes(building, violations);
      const Ring& outer = building.footprint.outer;
      if (may_touch || outer.empty()) continue;
      for (const std::uint32_t b : footprints.near(outer[0].x, outer[0].y))
        if (b != a && side_of(city.buildings[b].footprint, outer) > 0)
          note_violation(violations, "footprints that overlap", [&] {
            return fmt::format("building {} in building {}", building.id, city.buildings[b].id);
          });
    }
  };
  add_violations(check.violations, sum_of_violations(city.buildings.size(), look));
}

}  // namespace tetropolis
