#include "tetropolis/check/check_city.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/geometry/polygon.h"

#include "city_parts.h"
#include "core/infinity.h"
#include "segment_distance.h"
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

bool all_finite(const Polygon& polygon) {
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
    if (!all_finite(polygon)) note_violation(check.violations, kCoordinatesNotFinite, place);
    check.area += twice_area(polygon.outer) / 2;
    for (const Ring& hole : polygon.holes) {
      if (!(twice_area(hole) < 0)) note_violation(check.violations, "holes not clockwise", place);
      check.area += twice_area(hole) / 2;
    }
    if (!(building.h_roof > building.h_ground))
      note_violation(check.violations, "roofs not above the ground", place);
  }
}

/// The signed length of edges, by place: each as often as it runs one way, less the other.
class EdgeSum {
 public:
  void add(const Polygon& polygon, int sign) {
    for_each_ring(polygon, [&](const Ring& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) add(ring[i], ring[(i + 1) % ring.size()], sign);
    });
  }
  bool is_zero() const {
    return std::all_of(edges_.begin(), edges_.end(),
                       [](const auto& entry) { return entry.second == 0; });
  }

 private:
  using Edge = std::array<double, 4>;
  void add(Point2 a, Point2 b, int sign) {
    const bool forward = std::pair(a.x, a.y) < std::pair(b.x, b.y);
    edges_[forward ? Edge{a.x, a.y, b.x, b.y} : Edge{b.x, b.y, a.x, a.y}] += forward ? sign : -sign;
  }
  std::map<Edge, int> edges_;
};

double twice_area(const Polygon& polygon) {
  double sum = twice_area(polygon.outer);
  for (const Ring& hole : polygon.holes) sum += twice_area(hole);
  return sum;
}

/// Parts tile their footprint: the edges of all together are the footprint's, and so are the areas.
void check_parts(const CityModel& city, CityCheck& check) {
  constexpr double kOfArea = 1e-6;
  for (const Building& building : city.buildings) {
    if (building.parts.empty()) continue;
    EdgeSum edges;
    edges.add(building.footprint, -1);
    double area = 0, low = kInfinity;
    for (std::size_t k = 0; k < building.parts.size(); ++k) {
      const RoofPart& part = building.parts[k];
      const auto place = [&] { return fmt::format("part {} of building {}", k, building.id); };
      edges.add(part.outline, 1);
      area += twice_area(part.outline) / 2;
      if (part.outline.outer.size() < 3 || !(twice_area(part.outline.outer) > 0) ||
          !(twice_area(part.outline) > 0))
        note_violation(check.violations, "parts that are no counter-clockwise polygons", place);
      const RoofPlane& plane = part.roof;
      for (const double number :
           {plane.at.x, plane.at.y, plane.elevation, plane.slope_x, plane.slope_y})
        if (!std::isfinite(number))
          note_violation(check.violations, "roof planes that are not finite", place);
      for (const Point2 p : part.outline.outer)
        low = std::min(low, plane.elevation + plane.slope_x * (p.x - plane.at.x) +
                                plane.slope_y * (p.y - plane.at.y));
    }
    const auto place = [&] { return "building " + building.id; };
    check.parts += static_cast<std::int64_t>(building.parts.size());
    const double footprint = twice_area(building.footprint) / 2;
    if (!edges.is_zero() || !(std::abs(area - footprint) <= kOfArea * footprint))
      note_violation(check.violations, "parts that do not tile their footprint", place);
    if (!(low > building.h_ground))
      note_violation(check.violations, "roofs not above the ground", place);
  }
}

/// Between two corners of parts, or a corner and a line that it is no end of.
double clearance_of_parts(const Building& building) {
  std::set<std::pair<double, double>> corners;
  std::vector<std::pair<Point2, Point2>> edges;
  const auto add = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      corners.emplace(ring[i].x, ring[i].y);
      edges.emplace_back(ring[i], ring[(i + 1) % ring.size()]);
    }
  };
  for (const RoofPart& part : building.parts) for_each_ring(part.outline, add);
  double least = kInfinity;
  for (const auto& [a, b] : edges) {
    const double west = std::min(a.x, b.x), east = std::max(a.x, b.x);
    for (auto it = corners.lower_bound({west - least, -kInfinity});
         it != corners.end() && it->first <= east + least; ++it) {
      const Point2 p{it->first, it->second};
      if (!(p == a) && !(p == b)) least = std::min(least, segment_distance(p, a, b));
    }
    if (!(a == b)) least = std::min(least, std::hypot(b.x - a.x, b.y - a.y));
  }
  return least;
}

void check_part_lines(const CityModel& city, double min_distance, CityCheck& check) {
  for (const Building& building : city.buildings) {
    if (building.parts.empty()) continue;
    const double clearance = clearance_of_parts(building);
    check.part_clearance = std::min(check.part_clearance, clearance);
    if (!is_clear(clearance, min_distance))
      note_violation(check.violations, "lines of parts closer than the threshold", [&] {
        return fmt::format("building {}: {:.6f} m, {} m asked", building.id, clearance,
                           min_distance);
      });
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
  check_parts(city, check);
  check_account(city, check);
  check_edge_pairs(city, !min_distance.has_value(), check);
  check_nesting(city, !min_distance.has_value(), check);
  if (min_distance) {
    check_part_lines(city, *min_distance, check);
    if (!is_clear(check.min_clearance, *min_distance))
      note_violation(check.violations, "clearance below the threshold", [&] {
        return fmt::format("least clearance {:.6f} m, {} m asked: {}", check.min_clearance,
                           *min_distance, check.closest);
      });
    if (!city.domain.empty()) check_domain_distance(city, *min_distance, check);
  }
  return check;
}

}  // namespace tetropolis
