#include "city/largest_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <queue>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "city/edge_grid.h"
#include "city/grid_geometry.h"

namespace tetropolis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A region that can be asked for its nearest edge and whether it contains a point.
class Region {
 public:
  explicit Region(std::span<const Polygon> polygons) {
    double length = 0;
    for (const Polygon& polygon : polygons)
      for_each_edge(polygon, [&](Point2 a, Point2 b) {
        edges_.push_back({a, b});
        grid::extend(box_, a);
        length += grid::distance(a, b);
      });
    cell_ = length / static_cast<double>(std::max<std::size_t>(edges_.size(), 1)) + 1;
    index_ = EdgeGrid(box_, cell_, edges_.size());
    for (std::size_t i = 0; i < edges_.size(); ++i)
      index_.insert(static_cast<std::int32_t>(i), edges_[i].a, edges_[i].b);
  }

  struct Edge {
    Point2 a;
    Point2 b;
    double distance_to(Point2 p) const { return grid::point_segment_distance(p, a, b); }
  };

  /// Precondition: there are edges.
  const Edge& nearest(Point2 p) const {
    std::int32_t best = -1;
    double least = kInfinity;
    for (double reach = cell_ / 2; best < 0 || least > reach; reach *= 2) {
      index_.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(reach), [&](std::int32_t e) {
        const double d = edges_[static_cast<std::size_t>(e)].distance_to(p);
        if (d < least || (d == least && e < best)) {
          least = d;
          best = e;
        }
      });
      if (reach > 4 * (box_.width() + box_.height()) && best >= 0) break;
    }
    return edges_[static_cast<std::size_t>(best)];
  }

  bool contains(Point2 p) const {
    if (!box_.contains(p)) return false;
    crossed_.clear();
    index_.visit({box_.xmin, p.y, p.x, p.y}, [&](std::int32_t e) {
      Edge edge = edges_[static_cast<std::size_t>(e)];
      if ((edge.a.y > p.y) == (edge.b.y > p.y)) return;
      if (edge.a.y > edge.b.y) std::swap(edge.a, edge.b);
      const double side =
          (edge.b.x - edge.a.x) * (p.y - edge.a.y) - (edge.b.y - edge.a.y) * (p.x - edge.a.x);
      if (side < 0) crossed_.push_back(e);
    });
    std::sort(crossed_.begin(), crossed_.end());
    return std::distance(crossed_.begin(), std::unique(crossed_.begin(), crossed_.end())) % 2 == 1;
  }

  double distance_to(Point2 p) const { return contains(p) ? 0 : nearest(p).distance_to(p); }

 private:
  std::vector<Edge> edges_;
  Bounds2 box_{kInfinity, kInfinity, -kInfinity, -kInfinity};
  double cell_ = 1;
  EdgeGrid index_;
  mutable std::vector<std::int32_t> crossed_;
};

Point2 middle(Point2 p, Point2 q) { return {(p.x + q.x) / 2, (p.y + q.y) / 2}; }

class Search {
 public:
  Search(std::span<const Polygon> before, std::span<const Polygon> after, double tolerance,
         double floor)
      : before_(before), after_(after), tolerance_(tolerance), floor_(floor) {}

  /// Returns an upper bound of the distances along the edge.
  double along(const DifferenceEdge& edge);
  /// `on_edges`: an upper bound of the distances on the piece's edges.
  void inside(const DifferencePiece& piece, double on_edges);
  FarPoint best;

 private:
  struct Part {
    Point2 a;
    Point2 b;
  };
  struct Square {
    Point2 centre;
    double half;
    double bound;
    bool operator<(const Square& other) const { return bound < other.bound; }
  };
  void consider(Point2 p, double distance) {
    if (distance > best.distance) best = {distance, p};
  }

  Region before_, after_;
  double tolerance_;
  double floor_;
  std::vector<Part> parts_;
};

/// The points of an edge of one region that are outside the other one.
double Search::along(const DifferenceEdge& edge) {
  const Region& other = edge.of_after ? before_ : after_;
  double upper = 0;
  parts_.assign(1, {edge.a, edge.b});
  while (!parts_.empty()) {
    const Part part = parts_.back();
    parts_.pop_back();
    const double enough = best.distance + tolerance_;
    double bound = kInfinity, at_a = 0, at_b = 0;
    for (const Point2 p : {part.a, part.b}) {
      const Region::Edge& wall = other.nearest(p);
      const double da = wall.distance_to(part.a), db = wall.distance_to(part.b);
      bound = std::min(bound, std::max(da, db));
      (p == part.a ? at_a : at_b) = p == part.a ? da : db;
      if (bound <= enough) break;
    }
    if (bound <= enough) {
      upper = std::max(upper, bound);
      continue;
    }
    const double length = grid::distance(part.a, part.b);
    const Point2 m = middle(part.a, part.b);
    if (at_a > enough && !other.contains(part.a)) consider(part.a, at_a);
    if (at_b > enough && !other.contains(part.b)) consider(part.b, at_b);
    const double at_m = other.nearest(m).distance_to(m);
    if (at_m > best.distance || at_m >= length / 2) {
      const bool in = other.contains(m);
      if (!in) consider(m, at_m);
      if (in && at_m >= length / 2) continue;
    }
    if (length < tolerance_) {
      upper = std::max(upper, bound);
      continue;
    }
    parts_.push_back({part.a, m});
    parts_.push_back({m, part.b});
  }
  return upper;
}

void Search::inside(const DifferencePiece& piece, double on_edges) {
  Bounds2 box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (const DifferenceEdge& edge : piece.edges) {
    grid::extend(box, edge.a);
    grid::extend(box, edge.b);
  }
  // No point of the piece is farther from its edges than this.
  const double largest_disc =
      std::min({std::sqrt(piece.area / std::numbers::pi), box.width() / 2, box.height() / 2});
  const auto enough = [&] { return std::max(best.distance, floor_) + tolerance_; };
  if (on_edges + largest_disc <= enough()) return;
  std::priority_queue<Square> queue;
  const auto push = [&](Point2 centre, double half) {
    const double to_before = before_.distance_to(centre), to_after = after_.distance_to(centre);
    const double radius = half * std::numbers::sqrt2;
    const double far = std::max(to_before, to_after);
    if ((to_before > 0) != (to_after > 0)) consider(centre, far);
    if (to_before > radius && to_after > radius) return;  // outside both
    if (far + radius > enough()) queue.push({centre, half, far + radius});
  };
  push({(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2},
       std::max(box.width(), box.height()) / 2);
  while (!queue.empty()) {
    const Square top = queue.top();
    queue.pop();
    if (top.bound <= enough()) return;
    const double quarter = top.half / 2;
    for (const double dy : {-quarter, quarter})
      for (const double dx : {-quarter, quarter})
        push({top.centre.x + dx, top.centre.y + dy}, quarter);
  }
}

}  // namespace

FarPoint largest_distance(std::span<const Polygon> before, std::span<const Polygon> after,
                          std::span<const DifferencePiece> pieces, double tolerance, double floor) {
  if (pieces.empty()) return {};
  Search search(before, after, tolerance, floor);
  std::vector<double> on_edges(pieces.size(), 0);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const DifferenceEdge& edge : pieces[i].edges)
      on_edges[i] = std::max(on_edges[i], search.along(edge));
  for (std::size_t i = 0; i < pieces.size(); ++i) search.inside(pieces[i], on_edges[i]);
  return search.best;
}

}  // namespace tetropolis
