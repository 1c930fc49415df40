#include "city/roofs/separate_valleys.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "tetropolis/city/roofs.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"

namespace tetropolis {

namespace {

constexpr double kSame = 1e-3;  // metres: elevations that files do not tell apart

using Place = std::pair<double, double>;

/// A part's corner at a vertex.
struct Sector {
  double from = 0, to = 0;  ///< Directions of its sides, counter-clockwise, radians.
  double z = -kInfinity;    ///< Open ground is below all roofs.
  std::size_t part = 0;
  std::size_t ring = 0, corner = 0;  ///< 0: the outer ring.
  Point2 next, previous;             ///< Along the ring.
};

Ring& ring_of(RoofPart& part, std::size_t number) {
  return number == 0 ? part.outline.outer : part.outline.holes[number - 1];
}

/// By vertex, the corners of parts there.
std::map<Place, std::vector<Sector>> sectors_of(const Building& building) {
  std::map<Place, std::vector<Sector>> sectors;
  for (std::size_t k = 0; k < building.parts.size(); ++k) {
    const RoofPart& part = building.parts[k];
    for (std::size_t r = 0; r <= part.outline.holes.size(); ++r) {
      const Ring& ring = r == 0 ? part.outline.outer : part.outline.holes[r - 1];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point2 p = ring[i], next = ring[(i + 1) % ring.size()];
        const Point2 previous = ring[(i + ring.size() - 1) % ring.size()];
        Sector sector;
        sector.from = std::atan2(next.y - p.y, next.x - p.x);
        sector.to = std::atan2(previous.y - p.y, previous.x - p.x);
        if (sector.to <= sector.from) sector.to += 2 * std::numbers::pi;
        sector.z = part.roof(p);
        sector.part = k;
        sector.ring = r;
        sector.corner = i;
        sector.next = next;
        sector.previous = previous;
        sectors[{p.x, p.y}].push_back(sector);
      }
    }
  }
  for (auto& [place, list] : sectors) {
    std::sort(list.begin(), list.end(),
              [](const Sector& a, const Sector& b) { return a.from < b.from; });
    // What they leave is open ground.
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Sector& after = list[(i + 1) % list.size()];
      if (list[i].previous == after.next) continue;
      Sector ground;
      ground.part = building.parts.size();
      list.insert(list.begin() + static_cast<std::ptrdiff_t>(i) + 1, ground);
      ++i;
    }
  }
  return sectors;
}

/// The sectors of roofs that lie lower than those on both sides of them, and those that lie higher:
/// the shallowest first.
std::vector<std::size_t> extremes_at(const std::vector<Sector>& sectors) {
  const std::size_t n = sectors.size();
  std::vector<std::pair<double, std::size_t>> extremes;
  for (std::size_t i = 0; i < n; ++i) {
    const double here = sectors[i].z;
    if (here == -kInfinity) continue;
    const double before = sectors[(i + n - 1) % n].z - here, after = sectors[(i + 1) % n].z - here;
    if (std::min(before, after) > kSame || std::max(before, after) < -kSame)
      extremes.emplace_back(std::min(std::abs(before), std::abs(after)), i);
  }
  std::sort(extremes.begin(), extremes.end());
  std::vector<std::size_t> result;
  for (const auto& [depth, i] : extremes) result.push_back(i);
  return result;
}

bool is_valley(const std::vector<Sector>& sectors) {
  const std::size_t n = sectors.size();
  int falls = 0;
  // Each valley is entered by one fall that a rise follows.
  double direction = 0;
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const double a = sectors[i % n].z, b = sectors[(i + 1) % n].z;
    if (b > a + kSame) direction = 1;
    if (b < a - kSame) {
      if (direction > 0) ++falls;
      direction = -1;
    }
  }
  return falls > 2;  // twice around
}

/// The building with the corner of sector `low`, a valley or a peak, at p stepped back to q.
Building stepped_back(const Building& building, const std::vector<Sector>& sectors, std::size_t low,
                      Point2 p, Point2 q) {
  const std::size_t n = sectors.size();
  const Sector& valley = sectors[low];
  const Sector &before = sectors[(low + n - 1) % n], &after = sectors[(low + 1) % n];
  Building made = building;
  ring_of(made.parts[valley.part], valley.ring)[valley.corner] = q;
  const auto insert = [&](const Sector& sector, bool behind) {
    Ring& ring = ring_of(made.parts[sector.part], sector.ring);
    const auto at = std::find(ring.begin(), ring.end(), p);
    ring.insert(at + (behind ? 1 : 0), q);
  };
  insert(before, false);  // its ring comes along the valley's side to p
  insert(after, true);
  return made;
}

/// Whether a corner at q keeps clear of sides that do not end at p: most places do not, and are not
/// worth a look at the whole building.
bool is_free(const Building& building, Point2 p, Point2 q, double clearance) {
  bool free = true;
  for (const RoofPart& part : building.parts)
    for_each_edge(part.outline, [&](Point2 a, Point2 b) {
      if (a != p && b != p)
        free = free && is_clear(distance_to_segment(q, a, b), 0.999 * clearance);
    });
  return free;
}

/// Tries places for the corner; whether one was good.
bool step_back(Building& building, const std::vector<Sector>& sectors, std::size_t low, Point2 p,
               double clearance, double min_area) {
  const std::size_t n = sectors.size();
  const std::size_t before = sectors[(low + n - 1) % n].part, after = sectors[(low + 1) % n].part;
  const std::size_t ground = building.parts.size();
  if (before == ground || after == ground || before == after || sectors[low].part == before ||
      sectors[low].part == after)
    return false;
  const double middle = (sectors[low].from + sectors[low].to) / 2;
  for (const double length : {1.02, 1.2, 1.5, 2.0, 3.0})
    for (const double turn : {0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75}) {
      const double distance = clearance * length;
      const Point2 q = snap_coordinate(Point2{p.x + distance * std::cos(middle + turn),
                                              p.y + distance * std::sin(middle + turn)});
      if (!is_free(building, p, q, clearance)) continue;
      Building made = stepped_back(building, sectors, low, p, q);
      if (!part_defects(std::span(&made, 1), clearance, min_area, 1).empty()) continue;
      building = std::move(made);
      return true;
    }
  return false;
}

/// The outline of two parts that share a line; no outer ring if they touch at a corner besides.
Polygon united(const Polygon& a, const Polygon& b) {
  std::map<std::pair<Place, Place>, int> sides;
  for (const Polygon* polygon : {&a, &b})
    for_each_edge(*polygon, [&](Point2 p, Point2 q) {
      const auto other = sides.find({{q.x, q.y}, {p.x, p.y}});
      if (other != sides.end())
        sides.erase(other);
      else
        sides[{{p.x, p.y}, {q.x, q.y}}] = 1;
    });
  std::map<Place, Place> next;
  for (const auto& [side, one] : sides)
    if (!next.emplace(side.first, side.second).second) return {};
  Polygon whole;
  while (!next.empty()) {
    Ring ring;
    const Place start = next.begin()->first;
    Place at = start;
    do {
      const auto found = next.find(at);
      if (found == next.end()) return {};
      ring.push_back({at.first, at.second});
      at = found->second;
      next.erase(found);
    } while (at != start);
    if (!(signed_area(ring) > 0))
      whole.holes.push_back(std::move(ring));
    else if (whole.outer.empty())
      whole.outer = std::move(ring);
    else
      return {};
  }
  return whole;
}

/// Joins the part at sector `i` with the neighbour that is nearer in elevation, below the roof of
/// the larger one; whether that left no defect.
bool join(Building& building, const std::vector<Sector>& sectors, std::size_t i, double clearance,
          double min_area) {
  const std::size_t n = sectors.size(), ground = building.parts.size();
  const Sector& own = sectors[i];
  const Sector* nearest = nullptr;
  for (const Sector* other : {&sectors[(i + n - 1) % n], &sectors[(i + 1) % n]})
    if (other->part != ground && other->part != own.part &&
        (nearest == nullptr || std::abs(other->z - own.z) < std::abs(nearest->z - own.z)))
      nearest = other;
  if (nearest == nullptr) return false;
  Building made = building;
  RoofPart &a = made.parts[own.part], &b = made.parts[nearest->part];
  Polygon whole = united(a.outline, b.outline);
  if (whole.outer.empty()) return false;
  RoofPart part = area(a.outline) < area(b.outline) ? b : a;
  part.n_points = a.n_points + b.n_points;
  part.outline = std::move(whole);
  made.parts[std::min(own.part, nearest->part)] = std::move(part);
  made.parts.erase(made.parts.begin() +
                   static_cast<std::ptrdiff_t>(std::max(own.part, nearest->part)));
  if (!part_defects(std::span(&made, 1), clearance, min_area, 1).empty()) return false;
  building = std::move(made);
  return true;
}

}  // namespace

std::int64_t separate_valleys(Building& building, double clearance, double min_area) {
  std::vector<Place> given_up;
  for (;;) {
    bool changed = false;
    for (const auto& corner : sectors_of(building)) {
      const Place place = corner.first;
      const auto& sectors = corner.second;
      if (std::find(given_up.begin(), given_up.end(), place) != given_up.end()) continue;
      if (!is_valley(sectors)) continue;
      const Point2 p{place.first, place.second};
      const std::vector<std::size_t> extremes = extremes_at(sectors);
      const auto mends = [&](std::size_t i) {
        return step_back(building, sectors, i, p, clearance, min_area);
      };
      const auto joins = [&](std::size_t i) {
        return join(building, sectors, i, clearance, min_area);
      };
      changed = std::any_of(extremes.begin(), extremes.end(), mends) ||
                std::any_of(extremes.begin(), extremes.end(), joins);
      if (changed) break;
      given_up.push_back(place);
    }
    if (!changed) return static_cast<std::int64_t>(given_up.size());
  }
}

}  // namespace tetropolis
