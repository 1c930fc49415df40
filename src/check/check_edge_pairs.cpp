#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "city_parts.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "core/sort_once.h"
#include "geometry/grid_index.h"
#include "segment_distance.h"
#include "violations.h"

namespace tetropolis {

namespace {

/// Against rounding, where edges are filed.
constexpr double kMargin = 1e-3;

/// An edge of a ring, with where it comes from.
struct Edge {
  Point2 a, b;
  std::size_t building, ring, index, ring_size;
  double xmin() const { return std::min(a.x, b.x); }
  double xmax() const { return std::max(a.x, b.x); }
  double ymin() const { return std::min(a.y, b.y); }
  double ymax() const { return std::max(a.y, b.y); }
  double length() const { return std::hypot(a.x - b.x, a.y - b.y); }
};

bool adjacent(const Edge& e, const Edge& f) {
  if (e.building != f.building || e.ring != f.ring) return false;
  const std::size_t d = e.index > f.index ? e.index - f.index : f.index - e.index;
  return d <= 1 || d + 1 == e.ring_size;
}

double turn(Point2 a, Point2 b, Point2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool cross_properly(const Edge& e, const Edge& f) {
  const double s1 = turn(e.a, e.b, f.a), s2 = turn(e.a, e.b, f.b);
  const double s3 = turn(f.a, f.b, e.a), s4 = turn(f.a, f.b, e.b);
  return ((s1 > 0 && s2 < 0) || (s1 < 0 && s2 > 0)) && ((s3 > 0 && s4 < 0) || (s3 < 0 && s4 > 0));
}

/// Between vertices, and vertices and edges; 0 where vertices coincide that are not the one that
/// neighbours share.
double clearance_of(const Edge& e, const Edge& f) {
  double least = kInfinity;
  for (const auto& [p, s] : {std::pair{e.a, &f}, {e.b, &f}, {f.a, &e}, {f.b, &e}}) {
    if (p != s->a && p != s->b)
      least = std::min(least, segment_distance(p, s->a, s->b));
    else if (!adjacent(e, f))
      least = 0;
  }
  return least;
}

/// Those with finite coordinates, from west to east.
std::vector<Edge> all_edges(const CityModel& city) {
  std::vector<Edge> edges;
  for (std::size_t b = 0; b < city.buildings.size(); ++b) {
    const Polygon& polygon = city.buildings[b].footprint;
    for (std::size_t r = 0; r <= polygon.holes.size(); ++r) {
      const Ring& ring = r == 0 ? polygon.outer : polygon.holes[r - 1];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Edge edge{ring[i], ring[(i + 1) % ring.size()], b, r, i, ring.size()};
        if (std::isfinite(edge.length())) edges.push_back(edge);
      }
    }
  }
  parallel_sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
    return std::make_tuple(e.xmin(), e.building, e.ring, e.index) <
           std::make_tuple(f.xmin(), f.building, f.ring, f.index);
  });
  return edges;
}

struct Found {
  double min_clearance = kInfinity;
  const Edge* closest = nullptr;  ///< One of the pair that has it; null if no pair is as near.
  std::size_t other = 0;          ///< The building of the other.
  std::vector<Violation> violations;
};

/// Looks at pairs of edges that are near each other.
class PairChecker {
 public:
  PairChecker(const CityModel& city, bool may_touch)
      : city_(city), may_touch_(may_touch), edges_(all_edges(city)) {
    for (const Edge& edge : edges_) reach_ = std::min(reach_, edge.length());
  }

  Found check() const {
    Bounds2 box = Bounds2::nothing();
    for (const Edge& edge : edges_)
      box.extend({edge.xmin(), edge.ymin(), edge.xmax(), edge.ymax()});
    const GridIndex filed = index_on_grid(
        edges_.size(), box, [&](const SquareGrid& grid, std::size_t e, const auto& use) {
          grid.for_each_along(edges_[e].a, edges_[e].b, kMargin, use);
        });
    Found found = parallel_reduce_ordered(
        edges_.size(), 4096, Found{},
        [&](std::size_t begin, std::size_t end) {
          Found part;
          std::vector<std::uint32_t> others;
          for (std::size_t e = begin; e < end; ++e) {
            collect(filed, e, others);
            for (const std::uint32_t f : others) look(edges_[e], edges_[f], part);
          }
          return part;
        },
        [](Found sum, const Found& part) {
          if (part.min_clearance < sum.min_clearance) {
            sum.min_clearance = part.min_clearance;
            sum.closest = part.closest;
            sum.other = part.other;
          }
          add_violations(sum.violations, part.violations);
          return sum;
        });
    found.min_clearance = std::min(found.min_clearance, reach_);
    return found;
  }

 private:
  /// The edges before edge e that come near it, ascending.
  void collect(const GridIndex& filed, std::size_t e, std::vector<std::uint32_t>& others) const {
    others.clear();
    const Edge& edge = edges_[e];
    filed.grid.for_each_along(edge.a, edge.b, reach_ + kMargin, [&](std::size_t square) {
      for (const std::uint32_t f : filed.rows[square]) {
        if (f >= e) break;
        if (!far(edge, edges_[f])) others.push_back(f);
      }
    });
    sort_once(others);
  }

  bool far(const Edge& e, const Edge& f) const {
    return e.xmax() + reach_ < f.xmin() || f.xmax() + reach_ < e.xmin() ||
           e.ymax() + reach_ < f.ymin() || f.ymax() + reach_ < e.ymin();
  }

  void look(const Edge& e, const Edge& f, Found& found) const {
    const bool same_building = e.building == f.building;
    if (may_touch_ && !same_building) return;
    if (cross_properly(e, f))
      note_violation(found.violations, "rings that cross", [&] {
        return fmt::format("buildings {} and {} near ({:.4f}, {:.4f})",
                           city_.buildings[e.building].id, city_.buildings[f.building].id,
                           e.a.x + city_.origin.x, e.a.y + city_.origin.y);
      });
    if (const double least = clearance_of(e, f); least < found.min_clearance) {
      found.min_clearance = least;
      found.closest = &e;
      found.other = f.building;
    }
  }

  const CityModel& city_;
  bool may_touch_;
  std::vector<Edge> edges_;
  /// The shortest edge: its ends are as near to each other, so what is further apart does not
  /// matter.
  double reach_ = kInfinity;
};

}  // namespace

void check_edge_pairs(const CityModel& city, bool may_touch, CityCheck& check) {
  const PairChecker pairs(city, may_touch);
  const Found found = pairs.check();
  check.min_clearance = found.min_clearance;
  if (found.closest != nullptr)
    check.closest =
        fmt::format("{} and {} at ({:.3f}, {:.3f})", city.buildings[found.closest->building].id,
                    city.buildings[found.other].id, found.closest->a.x + city.origin.x,
                    found.closest->a.y + city.origin.y);
  add_violations(check.violations, found.violations);
}

}  // namespace tetropolis
