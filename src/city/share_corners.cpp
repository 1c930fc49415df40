#include "share_corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "geometry/vec2.h"

namespace tetropolis {

namespace {

constexpr std::size_t kMostCorners = 10000;

/// Numbers of corners.
using IndexRing = std::vector<std::size_t>;

/// Without what runs to a corner and straight back, or stays where it is.
IndexRing without_spikes(const IndexRing& ring) {
  IndexRing result;
  for (const std::size_t v : ring) {
    if (!result.empty() && result.back() == v) continue;
    if (result.size() > 1 && result[result.size() - 2] == v)
      result.pop_back();
    else
      result.push_back(v);
  }
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return result;
}

class Corners {
 public:
  explicit Corners(double tolerance) : tolerance_(tolerance) {}

  bool too_many() const { return places_.size() > kMostCorners; }

  IndexRing add(const Ring& ring) {
    IndexRing numbers;
    for (const Point2& p : ring) numbers.push_back(add(p));
    return without_spikes(numbers);
  }

  /// After all have been added.
  IndexRing split(const IndexRing& ring) {
    if (by_x_.empty()) {
      for (std::size_t v = 0; v < places_.size(); ++v) by_x_.emplace_back(places_[v].x, v);
      std::sort(by_x_.begin(), by_x_.end());
    }
    IndexRing split;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      split.push_back(ring[i]);
      append_between(ring[i], ring[(i + 1) % ring.size()], split);
    }
    return without_spikes(split);
  }

  Ring places(const IndexRing& ring) const {
    Ring result;
    for (const std::size_t v : ring) result.push_back(places_[v]);
    return result;
  }

 private:
  /// The number of the corner at `p`, or within the tolerance of it.
  std::size_t add(Point2 p) {
    const auto cell_x = static_cast<std::int64_t>(std::floor(p.x / tolerance_));
    const auto cell_y = static_cast<std::int64_t>(std::floor(p.y / tolerance_));
    for (std::int64_t x = cell_x - 1; x <= cell_x + 1; ++x)
      for (std::int64_t y = cell_y - 1; y <= cell_y + 1; ++y) {
        const auto it = cells_.find({x, y});
        if (it == cells_.end()) continue;
        for (const std::size_t v : it->second)
          if (distance(places_[v], p) <= tolerance_) return v;
      }
    cells_[{cell_x, cell_y}].push_back(places_.size());
    places_.push_back(p);
    return places_.size() - 1;
  }

  void append_between(std::size_t from, std::size_t to, IndexRing& ring) const {
    const Point2 a = places_[from], b = places_[to];
    Bounds2 box = Bounds2::nothing();
    box.extend(a);
    box.extend(b);
    box = box.grown(tolerance_);
    std::vector<std::pair<double, std::size_t>> on;
    for (auto it =
             std::lower_bound(by_x_.begin(), by_x_.end(), std::pair{box.xmin, std::size_t{0}});
         it != by_x_.end() && it->first <= box.xmax; ++it) {
      const std::size_t v = it->second;
      if (v == from || v == to || !box.contains(places_[v])) continue;
      if (distance(places_[v], nearest_on_segment(places_[v], a, b)) <= tolerance_)
        on.emplace_back(distance(a, places_[v]), v);
    }
    std::sort(on.begin(), on.end());
    for (const auto& [away, v] : on) ring.push_back(v);
  }

  double tolerance_;
  std::vector<Point2> places_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells_;
  std::vector<std::pair<double, std::size_t>> by_x_;
};

void turn(Ring& ring, bool counter_clockwise) {
  if ((signed_area(ring) > 0) != counter_clockwise) std::reverse(ring.begin() + 1, ring.end());
}

struct OuterEdge {
  Point2 a, b;
  bool operator<(const OuterEdge& other) const {
    return std::tie(a.y, a.x, b.y, b.x) < std::tie(other.a.y, other.a.x, other.b.y, other.b.x);
  }
};

/// The edges that one polygon has alone.
std::vector<OuterEdge> outer_edges(std::span<const Polygon> polygons) {
  std::vector<OuterEdge> edges, alone;
  for (const Polygon& polygon : polygons)
    for_each_edge(polygon, [&](Point2 a, Point2 b) { edges.push_back({a, b}); });
  std::sort(edges.begin(), edges.end());
  for (const OuterEdge& edge : edges)
    if (!std::binary_search(edges.begin(), edges.end(), OuterEdge{edge.b, edge.a}))
      alone.push_back(edge);
  return alone;
}

}  // namespace

std::optional<std::vector<Polygon>> share_corners(std::span<const Polygon> polygons,
                                                  double tolerance) {
  Corners corners(tolerance);
  std::vector<std::vector<IndexRing>> numbered;
  for (const Polygon& polygon : polygons) {
    std::vector<IndexRing>& rings = numbered.emplace_back();
    rings.push_back(corners.add(polygon.outer));
    for (const Ring& hole : polygon.holes) rings.push_back(corners.add(hole));
    if (corners.too_many()) return std::nullopt;
  }
  std::vector<Polygon> shared;
  for (const std::vector<IndexRing>& rings : numbered) {
    Polygon& polygon = shared.emplace_back();
    for (std::size_t r = 0; r < rings.size(); ++r) {
      Ring ring = corners.places(corners.split(rings[r]));
      if (ring.size() < 3 || signed_area(ring) == 0) {
        if (r == 0) return std::nullopt;
        continue;
      }
      turn(ring, r == 0);
      if (r == 0)
        polygon.outer = std::move(ring);
      else
        polygon.holes.push_back(std::move(ring));
    }
  }
  return shared;
}

std::optional<Polygon> common_outline(std::span<const Polygon> polygons) {
  const std::vector<OuterEdge> edges = outer_edges(polygons);
  Polygon outline;
  std::vector<bool> used(edges.size(), false);
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (used[first]) continue;
    Ring ring;
    for (std::size_t at = first; !used[at];) {
      used[at] = true;
      ring.push_back(edges[at].a);
      const Point2 next = edges[at].b;
      const auto it =
          std::lower_bound(edges.begin(), edges.end(), next, [](const OuterEdge& edge, Point2 p) {
            return std::tie(edge.a.y, edge.a.x) < std::tie(p.y, p.x);
          });
      if (it == edges.end() || !(it->a == next)) return std::nullopt;
      if (it + 1 != edges.end() && (it + 1)->a == next) return std::nullopt;
      at = static_cast<std::size_t>(it - edges.begin());
    }
    if (signed_area(ring) < 0)
      outline.holes.push_back(std::move(ring));
    else if (outline.outer.empty())
      outline.outer = std::move(ring);
    else
      return std::nullopt;
  }
  if (outline.outer.empty()) return std::nullopt;
  return outline;
}

}  // namespace tetropolis
