#include "city/roofs/partition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/is_among.h"
#include "geometry/predicates.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

/// Lines nearer to each other than a millimetre touch.
constexpr double kTouch = 1e-3;

bool touch(Point2 p, Point2 q, Point2 a, Point2 b) {
  return distance_to_segment(a, p, q) < kTouch || distance_to_segment(b, p, q) < kTouch ||
         distance_to_segment(p, a, b) < kTouch || distance_to_segment(q, a, b) < kTouch;
}

/// Whether the segments from `common` to p and to q run over each other.
bool overlap(Point2 common, Point2 p, Point2 q) {
  const double along = (p.x - common.x) * (q.x - common.x) + (p.y - common.y) * (q.y - common.y);
  return along > 0 &&
         (distance_to_segment(p, common, q) < kTouch || distance_to_segment(q, common, p) < kTouch);
}

}  // namespace

Partition::Partition(const Bounds2& box, double reach) : box_(box) {
  constexpr double kMostCells = 256;  // in either direction
  cell_ = std::max({2 * reach, box.width() / kMostCells, box.height() / kMostCells});
  columns_ = static_cast<std::size_t>(box.width() / cell_) + 1;
  rows_ = static_cast<std::size_t>(box.height() / cell_) + 1;
  grid_.resize(columns_ * rows_);
}

std::array<std::size_t, 4> Partition::cells(const Bounds2& box) const {
  const auto cell = [&](double distance, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(distance, 0.0) / cell_), count - 1);
  };
  return {cell(box.xmin - box_.xmin, columns_), cell(box.ymin - box_.ymin, rows_),
          cell(box.xmax - box_.xmin, columns_), cell(box.ymax - box_.ymin, rows_)};
}

Partition::NodeId Partition::add_node(Point2 p, bool corner, bool on_outline) {
  nodes_.push_back({p, corner, on_outline});
  return nodes_.size() - 1;
}

void Partition::enter(EdgeId e) {
  const std::array<std::size_t, 4> range = cells(box_of(e));
  for (std::size_t y = range[1]; y <= range[3]; ++y)
    for (std::size_t x = range[0]; x <= range[2]; ++x) {
      std::vector<EdgeId>& cell = grid_[y * columns_ + x];
      if (!is_among(e, cell)) cell.push_back(e);
    }
}

Partition::EdgeId Partition::add_edge(NodeId a, NodeId b, Region left, Region right) {
  const EdgeId e = edges_.size();
  edges_.push_back({a, b, left, right});
  nodes_[a].edges.push_back(e);
  nodes_[b].edges.push_back(e);
  enter(e);
  is_tidy_ = false;
  return e;
}

void Partition::remove(EdgeId e) {
  const std::array<std::size_t, 4> range = cells(box_of(e));
  for (std::size_t y = range[1]; y <= range[3]; ++y)
    for (std::size_t x = range[0]; x <= range[2]; ++x) std::erase(grid_[y * columns_ + x], e);
  edges_[e].alive = false;
  for (const NodeId n : {edges_[e].a, edges_[e].b}) std::erase(nodes_[n].edges, e);
  is_tidy_ = false;
}

void Partition::redirect(EdgeId e, NodeId from, NodeId to) {
  std::erase(nodes_[from].edges, e);
  nodes_[to].edges.push_back(e);
  (edges_[e].a == from ? edges_[e].a : edges_[e].b) = to;
  enter(e);
  is_tidy_ = false;
}

double Partition::length(EdgeId e) const { return distance(at(edges_[e].a), at(edges_[e].b)); }

Partition::EdgeId Partition::edge_between(NodeId a, NodeId b) const {
  for (const EdgeId e : nodes_[a].edges)
    if (edges_[e].has(b)) return e;
  return kNone;
}

bool Partition::is_free(Point2 p, Point2 q, NodeId n, NodeId m,
                        std::span<const EdgeId> ignored) const {
  bool free = true;
  for_each_edge_near(bounds(std::array{p, q}).grown(kTouch), [&](EdgeId e) {
    if (!free || is_among(e, ignored)) return;
    const Edge& edge = edges_[e];
    if (edge.has(n) && edge.has(m))
      free = false;
    else if (edge.has(n))
      free = !overlap(p, q, at(edge.other(n)));
    else if (edge.has(m))
      free = !overlap(q, p, at(edge.other(m)));
    else
      free = !segments_cross(p, q, at(edge.a), at(edge.b)) && !touch(p, q, at(edge.a), at(edge.b));
  });
  return free;
}

bool Partition::is_empty(Point2 a, Point2 b, Point2 c,
                         std::initializer_list<NodeId> ignored) const {
  if (orient2d(a, b, c) < 0) std::swap(b, c);
  const Bounds2 box = bounds(std::array{a, b, c});
  bool empty = true;
  for_each_edge_near(box, [&](EdgeId e) {
    for (const NodeId n : {edges_[e].a, edges_[e].b}) {
      const Point2 p = at(n);
      if (empty && box.contains(p) && !is_among(n, ignored))
        empty = orient2d(a, b, p) < 0 || orient2d(b, c, p) < 0 || orient2d(c, a, p) < 0;
    }
  });
  return empty;
}

void Partition::put(NodeId n, Point2 to) {
  nodes_[n].p = to;
  for (const EdgeId e : nodes_[n].edges) enter(e);
}

bool Partition::move(NodeId n, Point2 to) {
  if (nodes_[n].corner) return false;
  const Point2 from = at(n);
  for (const EdgeId e : nodes_[n].edges) {
    const NodeId o = edges_[e].other(n);
    if (distance(to, at(o)) < kTouch || !is_empty(from, to, at(o), {n, o})) return false;
  }
  // Edges at the node move with it: they may not run into each other, nor into others.
  put(n, to);
  for (const EdgeId e : nodes_[n].edges) {
    const NodeId o = edges_[e].other(n);
    const std::array<EdgeId, 1> ignored{e};
    if (!is_free(to, at(o), n, o, ignored)) {
      nodes_[n].p = from;
      return false;
    }
  }
  return true;
}

bool Partition::straighten(NodeId n) {
  const std::vector<EdgeId> pair = nodes_[n].edges;
  if (nodes_[n].corner || pair.size() != 2) return false;
  const NodeId a = edges_[pair[0]].other(n), b = edges_[pair[1]].other(n);
  if (a == b || !is_empty(at(a), at(n), at(b), {a, b, n}) || !is_free(at(a), at(b), a, b, pair))
    return false;
  join_straight(n);
  return true;
}

void Partition::join_straight(NodeId n) {
  const EdgeId e = nodes_[n].edges[0], f = nodes_[n].edges[1];
  const Edge first = edges_[e];
  const NodeId b = edges_[f].other(n);
  remove(e);
  remove(f);
  if (first.b == n)
    add_edge(first.a, b, first.left, first.right);
  else
    add_edge(b, first.b, first.left, first.right);
}

bool Partition::collapse(EdgeId e, NodeId kept, Point2 to) {
  const NodeId gone = edges_[e].other(kept);
  // A line between two places of the outline is no part of it.
  if (nodes_[gone].corner || (nodes_[gone].on_outline && !edges_[e].is_outline()) ||
      (nodes_[gone].on_outline && !nodes_[kept].on_outline))
    return false;
  const Point2 before = at(kept);
  if (!(to == before) && !move(kept, to)) return false;
  if (collapse_into(gone, kept, e)) return true;
  nodes_[kept].p = before;
  return false;
}

bool Partition::collapse_into(NodeId gone, NodeId kept, EdgeId e) {
  const Point2 to = at(kept);
  std::vector<EdgeId> moving = nodes_[gone].edges;
  for (const EdgeId f : moving) {
    const NodeId o = edges_[f].other(gone);
    if (f == e) continue;
    if (edge_between(o, kept) != kNone || !is_empty(at(gone), to, at(o), {gone, kept, o}) ||
        !is_free(to, at(o), kept, o, moving))
      return false;
  }
  std::erase(moving, e);
  remove(e);
  for (const EdgeId f : moving) redirect(f, gone, kept);
  return true;
}

void Partition::split(EdgeId e, NodeId n) {
  const Edge edge = edges_[e];
  remove(e);
  add_edge(edge.a, n, edge.left, edge.right);
  add_edge(n, edge.b, edge.left, edge.right);
}

bool Partition::lead_through(EdgeId e, NodeId n) {
  const NodeId a = edges_[e].a, b = edges_[e].b;
  const std::array<EdgeId, 1> ignored{e};
  if (edge_between(n, a) != kNone || edge_between(n, b) != kNone ||
      !is_empty(at(a), at(n), at(b), {a, b, n}) || !is_free(at(a), at(n), a, n, ignored) ||
      !is_free(at(n), at(b), n, b, ignored))
    return false;
  split(e, n);
  return true;
}

Partition::NodeId Partition::end_of(NodeId from, std::span<const EdgeId> path) const {
  for (const EdgeId e : path) from = edges_[e].other(from);
  return from;
}

void Partition::fold_onto(EdgeId e, EdgeId g, NodeId n, bool left) {
  const NodeId common = edges_[g].other(n), far = edges_[e].other(common);
  const auto side = [&](EdgeId id, bool on_left) {
    return (edges_[id].a == common) == on_left ? edges_[id].left : edges_[id].right;
  };
  // The face between both is beside neither of what remains.
  const Region beyond_node = side(g, left), beyond_edge = side(e, !left);
  const Region left_of_edge = side(e, true), right_of_edge = side(e, false);
  remove(e);
  remove(g);
  add_edge(common, n, left ? beyond_node : beyond_edge, left ? beyond_edge : beyond_node);
  add_edge(n, far, left_of_edge, right_of_edge);
}

bool Partition::fold(EdgeId e, NodeId n) {
  const EdgeId to_a = edge_between(n, edges_[e].a), to_b = edge_between(n, edges_[e].b);
  if (edges_[e].has(n) || (to_a == kNone) == (to_b == kNone)) return false;
  const EdgeId g = to_a != kNone ? to_a : to_b;
  const NodeId common = edges_[g].other(n), far = edges_[e].other(common);
  const std::array<EdgeId, 1> ignored{e};
  if (!is_empty(at(common), at(n), at(far), {common, n, far}) ||
      !is_free(at(n), at(far), n, far, ignored))
    return false;
  fold_onto(e, g, n, orient2d(at(common), at(far), at(n)) > 0);
  return true;
}

bool Partition::move_onto(NodeId n, EdgeId e, Point2 x) {
  const NodeId a = edges_[e].a, b = edges_[e].b;
  const Point2 p = at(n);
  const EdgeId to_a = edge_between(n, a), to_b = edge_between(n, b);
  if (nodes_[n].on_outline || edges_[e].has(n) || distance(x, at(a)) < kTouch ||
      distance(x, at(b)) < kTouch || (to_a != kNone && to_b != kNone))
    return false;
  const EdgeId g = to_a != kNone ? to_a : to_b;
  const std::array<EdgeId, 2> ignored{e, g};
  for (const EdgeId f : nodes_[n].edges) {
    const NodeId o = edges_[f].other(n);
    if (!is_empty(p, x, at(o), {n, o})) return false;
    if (f != g && !is_free(x, at(o), n, o, ignored)) return false;
    // The others have to leave e on the side that the node comes from.
    if (f != g && orient2d(at(a), at(b), at(o)) != orient2d(at(a), at(b), p)) return false;
  }
  const NodeId common = g == kNone ? a : edges_[g].other(n);
  const bool left = orient2d(at(common), at(edges_[e].other(common)), p) > 0;
  const bool to_outline = edges_[e].is_outline();
  put(n, x);
  if (to_outline) nodes_[n].on_outline = true;
  if (g == kNone)
    split(e, n);
  else
    fold_onto(e, g, n, left);
  return true;
}

bool Partition::bend(EdgeId e, Point2 x) {
  const NodeId a = edges_[e].a, b = edges_[e].b;
  const std::array<EdgeId, 1> ignored{e};
  // Nodes of edges are known by number: the new one has none of its own yet.
  if (edges_[e].is_outline() || distance(x, at(a)) < kTouch || distance(x, at(b)) < kTouch ||
      !is_empty(at(a), x, at(b), {a, b}) || !is_free(at(a), x, a, kNone, ignored) ||
      !is_free(x, at(b), kNone, b, ignored))
    return false;
  split(e, add_node(x, false, false));
  return true;
}

bool Partition::branch_at(EdgeId g, NodeId a, EdgeId e, Point2 x) {
  const NodeId b = edges_[e].other(a), c = edges_[g].other(a);
  const std::array<EdgeId, 2> ignored{e, g};
  if (b == c || distance(x, at(a)) < kTouch || distance(x, at(b)) < kTouch ||
      !is_empty(at(a), x, at(c), {a, b, c}) || !is_free(x, at(c), a, c, ignored))
    return false;
  const bool g_left_of_e = orient2d(at(a), at(b), at(c)) > 0;
  const auto side = [&](EdgeId id, bool on_left) {
    return (edges_[id].a == a) == on_left ? edges_[id].left : edges_[id].right;
  };
  // Between a and x, what lies beyond g comes up to e.
  const Region beyond = side(g, g_left_of_e), left = side(e, true), right = side(e, false);
  const NodeId n = add_node(x, false, edges_[e].is_outline());
  redirect(g, a, n);
  remove(e);
  add_edge(a, n, g_left_of_e ? beyond : left, g_left_of_e ? right : beyond);
  add_edge(n, b, left, right);
  return true;
}

bool Partition::branch_at_end(EdgeId g, NodeId a, EdgeId e) {
  const NodeId b = edges_[e].other(a), c = edges_[g].other(a);
  const std::array<EdgeId, 2> ignored{e, g};
  if (b == c || edge_between(b, c) != kNone || !is_empty(at(a), at(b), at(c), {a, b, c}) ||
      !is_free(at(b), at(c), b, c, ignored))
    return false;
  const bool g_left_of_e = orient2d(at(a), at(b), at(c)) > 0;
  const Region beyond = (edges_[g].a == a) == g_left_of_e ? edges_[g].left : edges_[g].right;
  redirect(g, a, b);
  ((edges_[e].a == a) == g_left_of_e ? edges_[e].left : edges_[e].right) = beyond;
  return true;
}

bool Partition::push(EdgeId e, Region in, const OutlinePlace& from_a, const OutlinePlace& from_b) {
  const std::array<EdgeId, 3> ignored{e, from_a.on, from_b.on};
  if (from_a.on == from_b.on || !is_free(from_a.p, from_b.p, kNone, kNone, ignored)) return false;
  const bool in_left = edges_[e].left == in;
  const Region beyond = in_left ? edges_[e].right : edges_[e].left;
  const auto cross = [&](EdgeId side) {
    (edges_[side].left == in ? edges_[side].left : edges_[side].right) = beyond;
  };
  const auto end_at = [&](const OutlinePlace& place, NodeId corner) {
    for (const EdgeId side : place.passed) cross(side);
    const NodeId near = place.passed.empty() ? corner : end_of(corner, place.passed);
    const NodeId n = add_node(place.p, false, true);
    split(place.on, n);
    cross(edge_between(n, near));
    return n;
  };
  const NodeId a = end_at(from_a, edges_[e].a), b = end_at(from_b, edges_[e].b);
  remove(e);
  add_edge(a, b, in_left ? in : beyond, in_left ? beyond : in);
  is_tidy_ = false;
  return true;
}

void Partition::merge(Region keep, Region gone) {
  for (Edge& edge : edges_) {
    if (edge.left == gone) edge.left = keep;
    if (edge.right == gone) edge.right = keep;
  }
  is_tidy_ = false;
  tidy();
}

void Partition::tidy() {
  if (std::exchange(is_tidy_, true)) return;
  for (EdgeId e = 0; e < edges_.size(); ++e)
    if (edges_[e].alive && edges_[e].left == edges_[e].right) remove(e);
  for (NodeId n = 0; n < nodes_.size(); ++n)
    if (nodes_[n].on_outline && !nodes_[n].corner && nodes_[n].edges.size() == 2) join_straight(n);
}

std::vector<Partition::Face> Partition::faces() const {
  // Half-edge 2 e runs from a to b, 2 e + 1 back.
  const auto from = [&](std::size_t h) { return h % 2 == 0 ? edges_[h / 2].a : edges_[h / 2].b; };
  const auto to = [&](std::size_t h) { return from(h ^ 1); };
  const auto left = [&](std::size_t h) {
    return h % 2 == 0 ? edges_[h / 2].left : edges_[h / 2].right;
  };
  std::vector<std::size_t> next(2 * edges_.size(), kNone);
  for (NodeId n = 0; n < nodes_.size(); ++n) {
    std::vector<std::pair<double, std::size_t>> leaving;
    for (const EdgeId e : nodes_[n].edges) {
      const std::size_t h = edges_[e].a == n ? 2 * e : 2 * e + 1;
      const Point2 p = at(n), q = at(to(h));
      leaving.emplace_back(std::atan2(q.y - p.y, q.x - p.x), h);
    }
    std::sort(leaving.begin(), leaving.end());
    for (std::size_t k = 0; k < leaving.size(); ++k)
      next[leaving[(k + 1) % leaving.size()].second ^ 1] = leaving[k].second;
  }
  struct Loop {
    Region region;
    std::vector<NodeId> nodes;
    double area;
  };
  std::vector<Loop> outer, inner;
  std::vector<std::uint8_t> seen(2 * edges_.size(), 0);
  for (std::size_t start = 0; start < seen.size(); ++start) {
    if (seen[start] != 0 || !edges_[start / 2].alive || left(start) == kOutside) continue;
    Loop loop{left(start), {}, 0};
    for (std::size_t h = start; seen[h] == 0; h = next[h]) {
      seen[h] = 1;
      loop.nodes.push_back(from(h));
      const Point2 a = at(from(h)), b = at(to(h));
      loop.area +=
          ((a.x - box_.xmin) * (b.y - box_.ymin) - (b.x - box_.xmin) * (a.y - box_.ymin)) / 2;
    }
    (loop.area > 0 ? outer : inner).push_back(std::move(loop));
  }
  std::stable_sort(outer.begin(), outer.end(),
                   [](const Loop& a, const Loop& b) { return a.region < b.region; });
  std::vector<Face> result;
  for (Loop& loop : outer) {
    Face face;
    face.region = loop.region;
    face.area = loop.area;
    face.rings.push_back(std::move(loop.nodes));
    result.push_back(std::move(face));
  }
  for (Loop& hole : inner) {
    // The smallest face of its region around it.
    const auto around = [&](const Face& face) {
      const std::vector<NodeId>& ring = face.rings.front();
      for (const NodeId n : hole.nodes) {
        if (is_among(n, ring)) continue;
        bool inside = false;
        for (std::size_t i = 0; i < ring.size(); ++i)
          inside ^= crosses_ray(at(ring[i]), at(ring[(i + 1) % ring.size()]), at(n));
        return inside;
      }
      return true;
    };
    Face* best = nullptr;
    for (Face& face : result)
      if (face.region == hole.region && around(face) && (best == nullptr || face.area < best->area))
        best = &face;
    if (best == nullptr) continue;
    best->area += hole.area;
    best->rings.push_back(std::move(hole.nodes));
  }
  return result;
}

std::vector<Partition::Region> Partition::split_regions(Region next) {
  std::vector<Region> origin;
  const std::vector<Face> all = faces();
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin + 1;
    while (end < all.size() && all[end].region == all[begin].region) ++end;
    std::size_t largest = begin;
    for (std::size_t k = begin; k < end; ++k)
      if (all[k].area > all[largest].area) largest = k;
    for (std::size_t k = begin; k < end; ++k) {
      if (k == largest) continue;
      for (const std::vector<NodeId>& ring : all[k].rings)
        for (std::size_t i = 0; i < ring.size(); ++i) {
          Edge& edge = edges_[edge_between(ring[i], ring[(i + 1) % ring.size()])];
          (edge.a == ring[i] ? edge.left : edge.right) = next;
          is_tidy_ = false;
        }
      origin.push_back(all[k].region);
      ++next;
    }
    begin = end;
  }
  return origin;
}

Partition::Region Partition::region_at(Point2 p) const {
  // The first edge that the ray to the right crosses.
  double nearest = kInfinity;
  Region found = kOutside;
  const double y = p.y;
  for (double from = p.x; from <= box_.xmax && found == kOutside && nearest > 1e300;
       from += cell_) {
    for_each_edge_near({from, y, from + cell_, y}, [&](EdgeId e) {
      const Edge& edge = edges_[e];
      const Point2 a = at(edge.a), b = at(edge.b);
      if (!crosses_ray(a, b, p)) return;
      const double x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
      if (x >= nearest || x > from + cell_) return;
      nearest = x;
      found = a.y < b.y ? edge.left : edge.right;
    });
  }
  return found;
}

std::map<Partition::Region, double> Partition::areas() const {
  std::map<Region, double> result;
  for (const Edge& edge : edges_) {
    if (!edge.alive) continue;
    const Point2 a = at(edge.a), b = at(edge.b);
    const double part =
        ((a.x - box_.xmin) * (b.y - box_.ymin) - (b.x - box_.xmin) * (a.y - box_.ymin)) / 2;
    if (edge.left != kOutside) result[edge.left] += part;
    if (edge.right != kOutside) result[edge.right] -= part;
  }
  return result;
}

std::map<Partition::Region, double> Partition::neighbours(Region region) const {
  std::map<Region, double> result;
  for (EdgeId e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    if (!edge.alive || edge.is_outline()) continue;
    if (edge.left == region) result[edge.right] += length(e);
    if (edge.right == region) result[edge.left] += length(e);
  }
  return result;
}

}  // namespace tetropolis
