#include "tetropolis/check/check_city.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "tetropolis/city/simplify/clearance.h"

#include "city_parts.h"
#include "violations.h"

namespace tetropolis {

namespace {

double twice_area(const Ring& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
    sum += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
  }
  return sum;
}

bool is_finite(const Polygon& polygon) {
  const auto finite = [](const Ring& ring) {
    return std::all_of(ring.begin(), ring.end(),
                       [](Point2 p) { return std::isfinite(p.x) && std::isfinite(p.y); });
  };
  return finite(polygon.outer) && std::all_of(polygon.holes.begin(), polygon.holes.end(), finite);
}

void check_rings(const CityModel& city, CityCheck& check) {
  for (const Building& building : city.buildings) {
    const auto place = [&] { return "building " + building.id; };
    const Polygon& polygon = building.footprint;
    if (polygon.outer.size() < 3)
      note_violation(check.violations, "footprints with fewer than 3 vertices", place);
    if (!(twice_area(polygon.outer) > 0))
      note_violation(check.violations, "outer rings not counter-clockwise", place);
    if (!is_finite(polygon))
      note_violation(check.violations, "coordinates that are not finite", place);
    check.area += twice_area(polygon.outer) / 2;
    for (const Ring& hole : polygon.holes) {
      if (!(twice_area(hole) < 0)) note_violation(check.violations, "holes not clockwise", place);
      check.area += twice_area(hole) / 2;
    }
    if (!(building.h_roof > building.h_ground))
      note_violation(check.violations, "roofs not above the ground", place);
  }
}

void check_account(const CityModel& city, CityCheck& check) {
  std::map<std::string, int> seen;
  for (const Building& building : city.buildings) {
    if (building.source_ids.empty())
      note_violation(check.violations, "buildings without source",
                     [&] { return "building " + building.id; });
    for (const std::string& id : building.source_ids) ++seen[id];
  }
  for (const Dropped& dropped : city.dropped) ++seen[dropped.source_id];
  for (const auto& [id, count] : seen)
    if (count > 1)
      note_violation(check.violations, "input features accounted for more than once",
                     [&, id = id] { return "feature " + id; });
}

void check_domain_distance(const CityModel& city, double min_distance, CityCheck& check) {
  for (const Building& building : city.buildings)
    for (const Point2 p : building.footprint.outer) {
      const double distance = city.domain.distance_to_boundary(p);
      check.domain_distance = std::min(check.domain_distance, distance);
      if (!is_clear(distance, min_distance))
        note_violation(check.violations, "footprints too close to the domain's boundary",
                       [&] { return "building " + building.id; });
    }
}

}  // namespace

CityCheck check_city(const CityModel& city, std::optional<double> min_distance) {
  CityCheck check;
  check.buildings = static_cast<std::int64_t>(city.buildings.size());
  check.dropped = static_cast<std::int64_t>(city.dropped.size());
  check_rings(city, check);
  check_account(city, check);
  check_edge_pairs(city, !min_distance.has_value(), check);
  check_nesting(city, !min_distance.has_value(), check);
  if (min_distance) {
    if (!is_clear(check.min_clearance, *min_distance))
      note_violation(check.violations, "clearance below the threshold", [&] {
        return fmt::format("least clearance {:.6f} m, {} m asked", check.min_clearance,
                           *min_distance);
      });
    if (!city.domain.empty()) check_domain_distance(city, *min_distance, check);
  }
  return check;
}

}  // namespace tetropolis
