#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "tetropolis/check/check_mesh.h"

#include "violations.h"

namespace tetropolis {

namespace {

/// An edge of a ring, with where it comes from.
struct Edge {
  Point2 a, b;
  std::size_t building, ring, index, ring_size;
  double xmin() const { return std::min(a.x, b.x); }
  double xmax() const { return std::max(a.x, b.x); }
};

bool adjacent(const Edge& e, const Edge& f) {
  if (e.building != f.building || e.ring != f.ring) return false;
  const std::size_t d = e.index > f.index ? e.index - f.index : f.index - e.index;
  return d <= 1 || d + 1 == e.ring_size;
}

double point_segment(Point2 p, Point2 a, Point2 b) {
  const double ux = b.x - a.x, uy = b.y - a.y, wx = p.x - a.x, wy = p.y - a.y;
  const double c = ux * ux + uy * uy;
  const double t = c > 0 ? std::min(1.0, std::max(0.0, (wx * ux + wy * uy) / c)) : 0;
  return std::hypot(wx - t * ux, wy - t * uy);
}

double turn(Point2 a, Point2 b, Point2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool cross_properly(const Edge& e, const Edge& f) {
  const double s1 = turn(e.a, e.b, f.a), s2 = turn(e.a, e.b, f.b);
  const double s3 = turn(f.a, f.b, e.a), s4 = turn(f.a, f.b, e.b);
  return ((s1 > 0 && s2 < 0) || (s1 < 0 && s2 > 0)) && ((s3 > 0 && s4 < 0) || (s3 < 0 && s4 > 0));
}

std::vector<Edge> all_edges(const CityModel& city) {
  std::vector<Edge> edges;
  for (std::size_t b = 0; b < city.buildings.size(); ++b) {
    const Polygon& polygon = city.buildings[b].footprint;
    for (std::size_t r = 0; r <= polygon.holes.size(); ++r) {
      const Ring& ring = r == 0 ? polygon.outer : polygon.holes[r - 1];
      for (std::size_t i = 0; i < ring.size(); ++i)
        edges.push_back({ring[i], ring[(i + 1) % ring.size()], b, r, i, ring.size()});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
    return std::make_tuple(e.xmin(), e.building, e.ring, e.index) <
           std::make_tuple(f.xmin(), f.building, f.ring, f.index);
  });
  return edges;
}

double twice_area(const Ring& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
    sum += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
  }
  return sum;
}

void check_rings(const CityModel& city, CityCheck& check) {
  for (const Building& building : city.buildings) {
    const auto place = [&] { return "building " + building.id; };
    const Polygon& polygon = building.footprint;
    if (polygon.outer.size() < 3)
      note_violation(check.violations, "footprints with fewer than 3 vertices", place);
    if (!(twice_area(polygon.outer) > 0))
      note_violation(check.violations, "outer rings not counter-clockwise", place);
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

/// Sweeps over the edges by their left ends; only edges within `reach` of each other in x meet.
void check_pairs(const CityModel& city, double reach, bool may_touch, CityCheck& check) {
  const std::vector<Edge> edges = all_edges(city);
  std::vector<const Edge*> active;
  check.min_clearance = std::numeric_limits<double>::infinity();
  for (const Edge& e : edges) {
    std::erase_if(active, [&](const Edge* f) { return f->xmax() + reach < e.xmin(); });
    check.min_clearance = std::min(check.min_clearance, std::hypot(e.a.x - e.b.x, e.a.y - e.b.y));
    for (const Edge* f : active) {
      if (std::max(e.a.y, e.b.y) + reach < std::min(f->a.y, f->b.y) ||
          std::max(f->a.y, f->b.y) + reach < std::min(e.a.y, e.b.y))
        continue;
      const bool same_building = e.building == f->building;
      const auto place = [&] {
        return fmt::format("buildings {} and {} near ({:.4f}, {:.4f})",
                           city.buildings[e.building].id, city.buildings[f->building].id,
                           e.a.x + city.origin.x, e.a.y + city.origin.y);
      };
      if ((same_building || !may_touch) && cross_properly(e, *f))
        note_violation(check.violations, "rings that cross", place);
      if (may_touch && !same_building) continue;
      for (const auto& [p, s] : {std::pair{e.a, f}, {e.b, f}, {f->a, &e}, {f->b, &e}}) {
        if (p == s->a || p == s->b) {
          // Neighbouring edges of a ring share a vertex; anything else that coincides is a
          // violation.
          if (!adjacent(e, *f)) check.min_clearance = 0;
          continue;
        }
        check.min_clearance = std::min(check.min_clearance, point_segment(p, s->a, s->b));
      }
    }
    active.push_back(&e);
  }
}

void check_domain_distance(const CityModel& city, double min_distance, CityCheck& check) {
  for (const Building& building : city.buildings)
    for (const Point2 p : building.footprint.outer) {
      const Bounds2& d = city.domain;
      const double distance = std::min({p.x - d.xmin, d.xmax - p.x, p.y - d.ymin, d.ymax - p.y});
      if (distance < min_distance)
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
  check_pairs(city, min_distance.value_or(0.0) + 1.0, !min_distance.has_value(), check);
  if (min_distance) {
    if (check.min_clearance < *min_distance)
      note_violation(check.violations, "clearance below the threshold", [&] {
        return fmt::format("least clearance {:.6f} m, {} m asked", check.min_clearance,
                           *min_distance);
      });
    if (!city.domain.empty()) check_domain_distance(city, *min_distance, check);
  }
  return check;
}

}  // namespace tetropolis
