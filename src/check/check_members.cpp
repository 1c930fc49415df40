#include "check_members.h"

#include <cstddef>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "geometry/predicates.h"
#include "violations.h"

namespace tetropolis {

namespace {

bool has_corner_near(const Polygon& of, const Polygon& other, double reach) {
  bool found = false;
  const auto look = [&](Point2 p, Point2) {
    found = found || contains(other, p) || distance_to_boundary(other, p) <= reach;
  };
  for_each_edge(of, look);
  return found;
}

bool edges_cross(const Polygon& a, const Polygon& b) {
  bool found = false;
  for_each_edge(a, [&](Point2 p, Point2 q) {
    for_each_edge(b, [&](Point2 r, Point2 s) {
      found = found || (orient2d(p, q, r) * orient2d(p, q, s) < 0 &&
                        orient2d(r, s, p) * orient2d(r, s, q) < 0);
    });
  });
  return found;
}

bool are_near(const Polygon& a, const Polygon& b, double reach) {
  return bounds(a).grown(reach).intersects(bounds(b)) &&
         (has_corner_near(a, b, reach) || has_corner_near(b, a, reach) || edges_cross(a, b));
}

}  // namespace

std::vector<Violation> check_members(const CityModel& raw, const CityModel& city, double reach) {
  std::unordered_multimap<std::string_view, const Building*> with_id;
  for (const Building& building : raw.buildings)
    for (const std::string& id : building.source_ids) with_id.emplace(id, &building);
  std::vector<Violation> violations;
  for (const Building& building : city.buildings)
    for (const std::string& id : building.source_ids) {
      const auto [begin, end] = with_id.equal_range(id);
      bool is_near = begin == end;
      for (auto it = begin; it != end && !is_near; ++it)
        is_near = are_near(it->second->footprint, building.footprint, reach);
      if (!is_near)
        note_violation(violations, "features far from the building that names them",
                       [&] { return fmt::format("{} in {}", id, building.id); });
    }
  return violations;
}

}  // namespace tetropolis
