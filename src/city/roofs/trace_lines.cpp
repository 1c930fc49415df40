#include "city/roofs/trace_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "geometry/vec2.h"

namespace tetropolis {

namespace {

using NodeId = Partition::NodeId;
using EdgeId = Partition::EdgeId;

constexpr double kTolerance = 0.5;  ///< Metres that a line may leave the border of the cells.
constexpr double kSnap = 0.75;      ///< Metres: borders so near to where two planes meet run there.

/// A line through `at` in the direction of the unit vector `along`.
struct Line {
  Point2 at, along;
  /// Of p, on the left.
  double offset(Point2 p) const { return (p.y - at.y) * along.x - (p.x - at.x) * along.y; }
};

Line line_between(Point2 a, Point2 b) {
  const double length = distance(a, b);
  return {a, {(b.x - a.x) / length, (b.y - a.y) / length}};
}

/// The line of least squares through a polyline's edges.
Line fit_line(std::span<const Point2> p) {
  if (p.size() == 2) return line_between(p[0], p[1]);
  double weight = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  const auto visit = [&](const auto& add) {
    for (std::size_t k = 0; k + 1 < p.size(); ++k)
      add(Point2{(p[k].x + p[k + 1].x) / 2, (p[k].y + p[k + 1].y) / 2}, distance(p[k], p[k + 1]));
  };
  visit([&](Point2 m, double w) { weight += w, x += w * m.x, y += w * m.y; });
  x /= weight, y /= weight;
  visit([&](Point2 m, double w) {
    xx += w * (m.x - x) * (m.x - x);
    xy += w * (m.x - x) * (m.y - y);
    yy += w * (m.y - y) * (m.y - y);
  });
  const double angle = std::atan2(2 * xy, xx - yy) / 2;
  return {{x, y}, {std::cos(angle), std::sin(angle)}};
}

/// Nothing for lines at less than 15 degrees.
std::optional<Point2> intersection(const Line& a, const Line& b) {
  const double sine = a.along.x * b.along.y - a.along.y * b.along.x;
  if (std::abs(sine) < 0.26) return {};
  const double t = ((b.at.x - a.at.x) * b.along.y - (b.at.y - a.at.y) * b.along.x) / sine;
  return Point2{a.at.x + t * a.along.x, a.at.y + t * a.along.y};
}

/// Where two planes meet, if they differ enough in slope. `near`: a place near to it.
std::optional<Line> ridge_of(const RoofPlane& a, const RoofPlane& b, Point2 near) {
  const double gx = a.slope_x - b.slope_x, gy = a.slope_y - b.slope_y;
  const double g = std::hypot(gx, gy);
  constexpr double kLeast = 0.1;
  if (!(g > kLeast)) return {};
  const double d = a(near) - b(near);
  return Line{{near.x - d * gx / (g * g), near.y - d * gy / (g * g)}, {-gy / g, gx / g}};
}

/// Indices of points of a polyline, so that it leaves the lines between them by no more than
/// `tolerance`.
std::vector<std::size_t> douglas_peucker(std::span<const Point2> p, double tolerance) {
  const std::size_t last = p.size() - 1;
  std::vector<std::size_t> kept{0, last};
  std::vector<std::pair<std::size_t, std::size_t>> stack{{0, last}};
  if (p[0] == p[last]) {
    std::size_t far = 0;
    for (std::size_t k = 0; k <= last; ++k)
      if (distance(p[k], p[0]) > distance(p[far], p[0])) far = k;
    kept.push_back(far);
    stack = {{0, far}, {far, last}};
  }
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    std::size_t far = i;
    double most = tolerance;
    for (std::size_t k = i + 1; k < j; ++k)
      if (const double d = distance_to_segment(p[k], p[i], p[j]); d > most) most = d, far = k;
    if (far == i) continue;
    kept.push_back(far);
    stack.emplace_back(i, far);
    stack.emplace_back(far, j);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

class Tracing {
 public:
  Tracing(const Polygon& footprint, const RoofCells& cells, const RoofRegions& regions,
          double reach)
      : cells_(cells), regions_(regions), lines_(bounds(footprint).grown(1), reach) {
    for_each_ring(footprint, [&](const Ring& ring) {
      for (const Point2 p : ring) corners_.insert({p.x, p.y});
    });
  }

  Partition run() {
    add_borders();
    find_chains();
    for (Chain& chain : chains_) simplify(chain);
    for (const Chain& chain : chains_) drop_between(chain);
    for (const Chain& chain : chains_) move_bends(chain);
    for (const auto& [node, lines] : at_junction_) move_junction(node, lines);
    return std::move(lines_);
  }

 private:
  struct Chain {
    std::vector<NodeId> nodes;
    std::vector<std::size_t> kept;  ///< Indices of nodes.
    std::vector<Line> lines;        ///< Between those kept.
  };

  NodeId node_at(VertexIndex v) {
    NodeId& node = node_[v];
    if (node == Partition::kNone) {
      const Point2 p = cells_.mesh.points[v];
      node = lines_.add_node(p, corners_.contains({p.x, p.y}), false);
    }
    return node;
  }

  void add_borders() {
    node_.assign(cells_.mesh.points.size(), Partition::kNone);
    for (std::size_t c = 0; c < cells_.size(); ++c)
      for (std::size_t e = 0; e < 3; ++e) {
        const CellNumber d = cells_.neighbours[c][e];
        const std::array<VertexIndex, 3>& triangle = cells_.mesh.triangles[c];
        const VertexIndex a = triangle[(e + 1) % 3], b = triangle[(e + 2) % 3];
        const RoofRegion here = regions_.of_cell[c];
        if (d < 0) {
          const NodeId p = node_at(a), q = node_at(b);
          lines_.put_on_outline(p);
          lines_.put_on_outline(q);
          lines_.add_edge(p, q, here, Partition::kOutside);
        } else if (static_cast<std::size_t>(d) > c &&
                   regions_.of_cell[static_cast<std::size_t>(d)] != here) {
          const NodeId p = node_at(a), q = node_at(b);
          lines_.add_edge(p, q, here, regions_.of_cell[static_cast<std::size_t>(d)]);
        }
      }
    lines_.tidy();  // samples of the outline that are no junctions
  }

  bool is_junction(NodeId n) const {
    return lines_.node(n).on_outline || lines_.node(n).edges.size() != 2;
  }

  void find_chains() {
    std::vector<std::uint8_t> used(lines_.edges().size(), 0);
    const auto is_open = [&](EdgeId e) {
      return lines_.edge(e).alive && !lines_.edge(e).is_outline() && used[e] == 0;
    };
    const auto walk = [&](EdgeId e, NodeId start) {
      Chain chain;
      chain.nodes.push_back(start);
      for (NodeId n = start;;) {
        used[e] = 1;
        n = lines_.edge(e).other(n);
        chain.nodes.push_back(n);
        if (is_junction(n) || n == start) break;
        const std::vector<EdgeId>& pair = lines_.node(n).edges;
        e = pair[0] == e ? pair[1] : pair[0];
      }
      chains_.push_back(std::move(chain));
    };
    const std::size_t count = lines_.edges().size();
    for (EdgeId e = 0; e < count; ++e)
      for (const NodeId end : {lines_.edge(e).a, lines_.edge(e).b})
        if (is_open(e) && is_junction(end)) walk(e, end);
    for (EdgeId e = 0; e < count; ++e)
      if (is_open(e)) walk(e, lines_.edge(e).a);
  }

  void simplify(Chain& chain) {
    std::vector<Point2> p;
    for (const NodeId n : chain.nodes) p.push_back(lines_.at(n));
    const std::size_t last = p.size() - 1;
    const bool closed = chain.nodes.front() == chain.nodes.back();
    const Partition::Edge& edge = lines_.edge(lines_.edge_between(chain.nodes[0], chain.nodes[1]));
    const auto roof = [&](Partition::Region r) {
      return regions_.roofs[static_cast<std::size_t>(r)].plane;
    };
    const std::optional<Line> ridge = ridge_of(roof(edge.left), roof(edge.right), p[0]);
    chain.kept = douglas_peucker(p, kTolerance);
    if (ridge && !closed) {
      double most = 0, sum = 0;
      for (const Point2 q : p) {
        most = std::max(most, std::abs(ridge->offset(q)));
        sum += std::abs(ridge->offset(q));
      }
      if (most < 2 * kSnap && sum < kSnap * static_cast<double>(p.size())) chain.kept = {0, last};
    }
    for (std::size_t s = 0; s + 1 < chain.kept.size(); ++s) {
      const std::size_t i = chain.kept[s], j = chain.kept[s + 1];
      const std::span<const Point2> piece(p.data() + i, j - i + 1);
      Line line = fit_line(piece);
      if (ridge && distance(p[i], p[j]) > 1) {
        double sum = 0;
        for (const Point2 q : piece) sum += std::abs(ridge->offset(q));
        if (sum < kSnap * static_cast<double>(piece.size())) line = *ridge;
      }
      chain.lines.push_back(line);
    }
    at_junction_[chain.nodes.front()].push_back(chain.lines.front());
    at_junction_[chain.nodes.back()].push_back(chain.lines.back());
  }

  void drop_between(const Chain& chain) {
    for (std::size_t s = 0; s + 1 < chain.kept.size(); ++s)
      for (std::size_t k = chain.kept[s] + 1; k < chain.kept[s + 1]; ++k)
        lines_.straighten(chain.nodes[k]);
  }

  void move_bends(const Chain& chain) {
    constexpr double kFarthest = 1.2;  // metres
    for (std::size_t s = 1; s + 1 < chain.kept.size(); ++s) {
      const NodeId n = chain.nodes[chain.kept[s]];
      if (lines_.node(n).edges.empty()) continue;
      const std::optional<Point2> x = intersection(chain.lines[s - 1], chain.lines[s]);
      if (x && distance(*x, lines_.at(n)) < kFarthest) lines_.move(n, *x);
    }
  }

  static constexpr double kMostMove = 1.5;  // metres

  /// Where the lines cross the outline, on average.
  std::optional<Point2> place_on_outline(NodeId n, const std::vector<Line>& lines) const {
    std::vector<Point2> ends;
    for (const EdgeId e : lines_.node(n).edges)
      if (lines_.edge(e).is_outline()) ends.push_back(lines_.at(lines_.edge(e).other(n)));
    if (ends.size() != 2) return {};
    const Line outline = line_between(ends[0], ends[1]);
    const double length = distance(ends[0], ends[1]);
    double sum = 0, count = 0;
    for (const Line& line : lines) {
      const std::optional<Point2> x = intersection(outline, line);
      if (!x || distance(*x, lines_.at(n)) > kMostMove) continue;
      sum += (x->x - outline.at.x) * outline.along.x + (x->y - outline.at.y) * outline.along.y;
      ++count;
    }
    if (count == 0) return {};
    const double t = std::clamp(sum / count, 1e-3 * length, (1 - 1e-3) * length);
    return Point2{outline.at.x + t * outline.along.x, outline.at.y + t * outline.along.y};
  }

  /// The place nearest to all lines.
  Point2 place_inside(NodeId n, const std::vector<Line>& lines) const {
    const Point2 p = lines_.at(n);
    constexpr double kStay = 0.05;
    double xx = kStay, xy = 0, yy = kStay, bx = 0, by = 0;
    for (const Line& line : lines) {
      const double nx = -line.along.y, ny = line.along.x, d = -line.offset(p);
      xx += nx * nx, xy += nx * ny, yy += ny * ny;
      bx += nx * d, by += ny * d;
    }
    const double det = xx * yy - xy * xy;
    Point2 by_far{(bx * yy - by * xy) / det, (by * xx - bx * xy) / det};
    const double length = std::hypot(by_far.x, by_far.y);
    const double share = length > kMostMove ? kMostMove / length : 1;
    return {p.x + share * by_far.x, p.y + share * by_far.y};
  }

  void move_junction(NodeId n, const std::vector<Line>& lines) {
    if (lines_.node(n).corner || lines_.node(n).edges.empty()) return;
    std::optional<Point2> x = place_inside(n, lines);
    if (lines_.node(n).on_outline) x = place_on_outline(n, lines);
    if (!x || lines_.move(n, *x)) return;
    const Point2 p = lines_.at(n);
    lines_.move(n, {(p.x + x->x) / 2, (p.y + x->y) / 2});
  }

  const RoofCells& cells_;
  const RoofRegions& regions_;
  Partition lines_;
  std::set<std::pair<double, double>> corners_;
  std::vector<NodeId> node_;  ///< Per vertex of the cells.
  std::vector<Chain> chains_;
  std::map<NodeId, std::vector<Line>> at_junction_;
};

}  // namespace

Partition trace_lines(const Polygon& footprint, const RoofCells& cells, const RoofRegions& regions,
                      double reach) {
  return Tracing(footprint, cells, regions, reach).run();
}

}  // namespace tetropolis
