#include "tetropolis/city/simplify/clearance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"

#include "city/edge_grid.h"
#include "city/grid_geometry.h"

namespace tetropolis {

namespace {

/// All edges of all rings, in order of polygon, ring and vertex.
struct Edges {
  std::vector<Point2> start;
  std::vector<Point2> end;
  std::vector<RingFeature> feature;
  std::vector<LineIndex> next;  ///< The edge that starts where this one ends.
  Bounds2 box = Bounds2::nothing();

  std::size_t size() const { return start.size(); }
  IndexRange<LineIndex> all() const { return indices<LineIndex>(size()); }
  void add(const Ring& ring, std::int32_t polygon, std::int32_t number) {
    const LineIndex base(size());
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const std::size_t after = (i + 1) % ring.size();
      start.push_back(ring[i]);
      end.push_back(ring[after]);
      feature.push_back({polygon, number, static_cast<std::int32_t>(i)});
      next.push_back(base + after);
      box.extend(start.back());
    }
  }
};

Edges edges_of(std::span<const Polygon> polygons) {
  Edges edges;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    const auto polygon = static_cast<std::int32_t>(k);
    edges.add(polygons[k].outer, polygon, 0);
    for (std::size_t h = 0; h < polygons[k].holes.size(); ++h)
      edges.add(polygons[k].holes[h], polygon, static_cast<std::int32_t>(h + 1));
  }
  return edges;
}

EdgeGrid grid_of(const Edges& edges) {
  double sum = 0;
  for (const LineIndex e : edges.all()) sum += grid::distance(edges.start[e], edges.end[e]);
  const double cell =
      std::max(sum / std::max(1.0, static_cast<double>(edges.size())), 1e-3 * edges.box.width());
  EdgeGrid index(edges.box, cell > 0 ? cell : 1.0, edges.size());
  for (const LineIndex e : edges.all()) index.insert(e, edges.start[e], edges.end[e]);
  return index;
}

void clear_of_domain(const Edges& edges, const Domain& domain, Clearance& best) {
  const std::size_t sides = domain.sides().size();
  for (const LineIndex v : edges.all()) {
    const Point2 p = edges.start[v];
    if (!domain.is_box()) {  // whose sides end
      const double d = std::max(0.0, domain.distance_to_boundary(p));
      if (d < best.distance) best = {d, edges.feature[v], RingFeature{-1, 0, 0}, p};
      continue;
    }
    for (std::size_t side = 0; side < sides; ++side) {
      const double d = std::max(0.0, domain.distance_to_side(side, p));
      if (d >= best.distance) continue;
      best = {d, edges.feature[v], RingFeature{-1, 0, static_cast<std::int32_t>(side)}, p};
    }
  }
}

}  // namespace

Clearance joint_clearance(std::span<const Polygon> polygons, const std::optional<Domain>& domain) {
  const Edges edges = edges_of(polygons);
  Clearance best;
  if (domain) clear_of_domain(edges, *domain, best);
  if (edges.size() == 0) return best;
  // No ring has a clearance above its shortest edge: that bounds the search from the start.
  double reach = std::min(best.distance, std::hypot(edges.box.width(), edges.box.height()));
  for (const LineIndex e : edges.all())
    if (edges.next[e] != e)
      reach = std::min(
          reach, std::hypot(edges.start[e].x - edges.end[e].x, edges.start[e].y - edges.end[e].y));
  const EdgeGrid index = grid_of(edges);
  for (const LineIndex v : edges.all()) {
    const Point2 p = edges.start[v];
    LineIndex best_edge = LineIndex::none();
    index.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(reach), [&](LineIndex e) {
      if (e == v || edges.next[e] == v) return;
      const double d = distance_to_segment(p, edges.start[e], edges.end[e]);
      const bool same_vertex = best.vertex == edges.feature[v] && best_edge.valid();
      if (d < best.distance || (d == best.distance && same_vertex && e < best_edge)) {
        best = {d, edges.feature[v], edges.feature[e], p};
        best_edge = e;
      }
    });
    if (best_edge.valid()) reach = std::min(reach, best.distance);
  }
  return best;
}

namespace {

class DefectFinder {
 public:
  DefectFinder(std::span<const Polygon> polygons, std::size_t limit)
      : polygons_(polygons), limit_(limit) {}

  std::vector<FootprintDefect> run() {
    check_rings();
    if (!defects_.empty()) return std::move(defects_);
    edges_ = edges_of(steps_);
    index_ = grid_of(edges_);
    check_crossings();
    if (defects_.empty()) check_nesting();
    return std::move(defects_);
  }

 private:
  void report(FootprintDefectKind kind, RingFeature first, RingFeature second, Point2 at,
              std::string_view what) {
    if (defects_.size() >= limit_) return;
    defects_.push_back({kind, first, second, at,
                        fmt::format("polygon {}, ring {}, vertex {} at ({:.4f}, {:.4f}): {}",
                                    first.polygon, first.ring, first.index, at.x, at.y, what)});
  }
  bool check_ring(const Ring& ring, std::int32_t polygon, std::int32_t number);
  void check_rings();
  void check_crossings();
  void check_pair(LineIndex e, LineIndex f);
  void check_nesting();
  bool right_of(LineIndex e, LineIndex f) const;
  LineIndex edge_left_of(LineIndex v) const;

  std::span<const Polygon> polygons_;
  std::size_t limit_;
  std::vector<Polygon> steps_;
  Edges edges_;
  EdgeGrid index_;
  std::vector<FootprintDefect> defects_;
};

bool DefectFinder::check_ring(const Ring& ring, std::int32_t polygon, std::int32_t number) {
  if (ring.size() < 3) {
    report(FootprintDefectKind::kTooFewVertices, {polygon, number, 0}, {},
           ring.empty() ? Point2{} : ring[0], "fewer than three vertices");
    return false;
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const RingFeature feature{polygon, number, static_cast<std::int32_t>(i)};
    const Point2 p = ring[i];
    if (!(std::abs(p.x) <= grid::kMaxCoordinate && std::abs(p.y) <= grid::kMaxCoordinate)) {
      report(FootprintDefectKind::kNotFinite, feature, {}, p,
             "coordinate not finite or beyond 1e9 m");
      return false;
    }
    if (snap_coordinate(p) != p)
      report(FootprintDefectKind::kOffGrid, feature, {}, p, "not on the coordinate grid");
  }
  if ((signed_area(ring) > 0) != (number == 0))
    report(FootprintDefectKind::kOrientation, {polygon, number, 0}, {}, ring[0],
           number == 0 ? "outer ring not counter-clockwise" : "hole not clockwise");
  return true;
}

void DefectFinder::check_rings() {
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    const auto polygon = static_cast<std::int32_t>(k);
    bool usable = check_ring(polygons_[k].outer, polygon, 0);
    for (std::size_t h = 0; h < polygons_[k].holes.size(); ++h)
      usable =
          check_ring(polygons_[k].holes[h], polygon, static_cast<std::int32_t>(h + 1)) && usable;
    if (usable) steps_.push_back(grid::to_steps(polygons_[k]));
  }
}

void DefectFinder::check_pair(LineIndex e, LineIndex f) {
  const Point2 a = edges_.start[e], b = edges_.end[e];
  const Point2 c = edges_.start[f], d = edges_.end[f];
  bool bad = false;
  if (edges_.next[e] == f) {
    bad = a == b || c == d || grid::folds_back(b, a, d);
  } else if (edges_.next[f] == e) {
    bad = a == b || c == d || grid::folds_back(a, b, c);
  } else {
    bad = grid::segments_touch(a, b, c, d);
  }
  if (bad)
    report(FootprintDefectKind::kRingsTouch, edges_.feature[e], edges_.feature[f],
           grid::to_metres(a),
           fmt::format("its edge crosses or touches the edge of polygon {}, ring {}, vertex {}",
                       edges_.feature[f].polygon, edges_.feature[f].ring, edges_.feature[f].index));
}

void DefectFinder::check_crossings() {
  std::vector<LineIndex> seen(edges_.size(), LineIndex::none());
  for (const LineIndex e : edges_.all()) {
    if (defects_.size() >= limit_) return;
    const Bounds2 box = grid::box_of(edges_.start[e], edges_.end[e]);
    index_.visit(box, [&](LineIndex f) {
      if (f <= e || seen[f] == e) return;
      seen[f] = e;
      check_pair(e, f);
    });
  }
}

/// Whether edge e is right of edge f at a height that both span, their lower ends included. Exact.
/// Precondition: they do not cross, but may have an end in common.
bool DefectFinder::right_of(LineIndex e, LineIndex f) const {
  Point2 e0 = edges_.start[e], e1 = edges_.end[e];
  Point2 f0 = edges_.start[f], f1 = edges_.end[f];
  if (e0.y > e1.y) std::swap(e0, e1);
  if (f0.y > f1.y) std::swap(f0, f1);
  const int lower = e0.y >= f0.y ? -grid::orientation(f0, f1, e0) : grid::orientation(e0, e1, f0);
  if (lower != 0) return lower > 0;
  return e1.y <= f1.y ? grid::orientation(f0, f1, e1) < 0 : grid::orientation(e0, e1, f1) > 0;
}

/// The edge of another ring that is nearest to the left of vertex v (which is a leftmost vertex of
/// its ring), or -1. Precondition: no edges touch.
LineIndex DefectFinder::edge_left_of(LineIndex v) const {
  const Point2 p = edges_.start[v];
  const RingFeature own = edges_.feature[v];
  LineIndex nearest = LineIndex::none();
  const auto look = [&](LineIndex e) {
    const Point2 a = edges_.start[e], b = edges_.end[e];
    const RingFeature other = edges_.feature[e];
    if (other.polygon == own.polygon && other.ring == own.ring) return;
    if (grid::crossing_side(a, b, p) >= 0) return;
    if (!nearest.valid() || (e != nearest && right_of(e, nearest))) nearest = e;
  };
  // Further and further to the west: nothing nearer comes once an edge crosses within the window.
  for (double west = p.x, width = edges_.box.width() / 256; west > edges_.box.xmin; width *= 4) {
    west = p.x - width;
    index_.visit({west, p.y, p.x, p.y}, look);
    if (!nearest.valid()) continue;
    const Point2 a = edges_.start[nearest], b = edges_.end[nearest];
    if (a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) > west + 1) break;
  }
  return nearest;
}

void DefectFinder::check_nesting() {
  LineIndex begin(0);
  while (begin < edges_.size()) {
    const RingFeature ring = edges_.feature[begin];
    LineIndex end = begin, leftmost = begin;
    while (end < edges_.size() && edges_.feature[end].polygon == ring.polygon &&
           edges_.feature[end].ring == ring.ring) {
      if (edges_.start[end].x < edges_.start[leftmost].x) leftmost = end;
      ++end;
    }
    begin = end;
    const LineIndex e = edge_left_of(leftmost);
    // The interior is on the left of an edge: it is on our side of edges that run down.
    const bool enclosed = e.valid() && edges_.start[e].y > edges_.end[e].y;
    const RingFeature first = edges_.feature[leftmost];
    const RingFeature around = e.valid() ? edges_.feature[e] : RingFeature{};
    const Point2 at = grid::to_metres(edges_.start[leftmost]);
    if (ring.ring == 0 && enclosed)
      report(FootprintDefectKind::kPolygonsOverlap, first, around, at,
             fmt::format("inside polygon {}", around.polygon));
    if (ring.ring != 0 && !(enclosed && around.polygon == ring.polygon))
      report(FootprintDefectKind::kHoleOutside, first, around, at, "hole not inside its polygon");
  }
}

}  // namespace

std::vector<FootprintDefect> footprint_defects(std::span<const Polygon> polygons,
                                               std::size_t limit) {
  return DefectFinder(polygons, limit).run();
}

}  // namespace tetropolis
