#include "outline_change.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "city/grid_geometry.h"

namespace tetropolis {

using grid::point_segment_distance;

namespace {

/// How much worse a pair of two polygons is than one of the same.
constexpr double kOtherPolygon = 10;

/// The largest distance of a vertex of either path to the other path: no point of the region
/// between them is farther from them.
double displacement(const ShortPath& before, const ShortPath& after) {
  double largest = 0;
  for (const auto& [from, to] : {std::pair{&before, &after}, std::pair{&after, &before}})
    for (int i = 1; i + 1 < from->count; ++i) {
      double nearest = ShortPath::kNowhere;
      for (int j = 0; j < to->edges; ++j)
        nearest = std::min(nearest, point_segment_distance(from->at(i), to->at(j), to->at(j + 1)));
      largest = std::max(largest, nearest);
    }
  return largest;
}

/// At least the radius of any disk within a loop: half of its extent across one of its edges.
double most_inradius(const Ring& loop) {
  double least = kInfinity;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Point2 a = loop[i], b = loop[(i + 1) % loop.size()];
    const double length = grid::distance(a, b);
    if (!(length > 0)) continue;
    double low = 0, high = 0;
    for (const Point2 p : loop) {
      const double across = ((p.x - a.x) * (b.y - a.y) - (p.y - a.y) * (b.x - a.x)) / length;
      low = std::min(low, across);
      high = std::max(high, across);
    }
    least = std::min(least, (high - low) / 2);
  }
  return least;
}

}  // namespace

OutlineChange vertex_change(const Outline& o, OutlineVertex v, ChangeKind kind) {
  OutlineChange c;
  c.kind = kind;
  c.first = o.before(v);
  c.last = o.after(v);
  c.old = {v, kNoOutlineVertex};
  c.old_count = 1;
  return c;
}

ShortPath old_path(const Outline& o, const OutlineChange& c) {
  ShortPath path;
  path.add(o.at(c.first));
  for (const OutlineVertex v : c.old_vertices()) path.add(o.at(v));
  path.add(o.at(c.last));
  return path;
}

ShortPath new_path(const Outline& o, const OutlineChange& c) {
  ShortPath path;
  path.add(o.at(c.first));
  for (const Point2 p : c.fresh_points()) path.add(p);
  path.add(o.at(c.last));
  return path;
}

void replace_vertices(Outline& o, const OutlineChange& c) {
  const ShortPath before = old_path(o, c), after = new_path(o, c);
  o.changed[o.polygon_of(c.first)] = 1;
  ++o.edits;
  OutlineVertex v = c.first;
  for (int j = 0; j < before.edges; ++j) {
    o.grid.remove(v, before.at(j), before.at(j + 1));
    v = o.after(v);
  }
  const OutlineRing ring = o.ring_of(c.first);
  const std::span<const OutlineVertex> old = c.old_vertices();
  for (const OutlineVertex gone : old) o.next[gone] = kNoOutlineVertex;
  v = c.first;
  for (std::size_t i = 0; const Point2 p : c.fresh_points()) {
    OutlineVertex w = o.point.next();
    if (i < old.size()) {
      w = old[i++];
      o.point[w] = p;
    } else {
      o.point.push_back(p);
      o.next.push_back(kNoOutlineVertex);
      o.prev.push_back(kNoOutlineVertex);
      o.ring.push_back(ring);
    }
    o.next[v] = w;
    o.prev[w] = v;
    v = w;
  }
  o.next[v] = c.last;
  o.prev[c.last] = v;
  o.size[ring] += c.fresh_count - c.old_count;
  if (!o.alive(o.first[ring])) o.first[ring] = c.last;
  v = c.first;
  for (int j = 0; j < after.edges; ++j) {
    o.grid.insert(v, after.at(j), after.at(j + 1));
    v = o.after(v);
  }
}

void ChangeJudge::gather(const ShortPath& before, const ShortPath& after, const OutlineChange& c) {
  gather_before(before, c);
  gather_along(after, epsilon_);
}

/// What is near the old path, which is the same for all changes of the same vertices.
void ChangeJudge::gather_before(const ShortPath& before, const OutlineChange& c) {
  if (before_.first == c.first && before_.old == c.old && before_.edits == o_.edits) {
    ++gathering_;
    near_.resize(before_.near_count);
    return;
  }
  near_.clear();
  gathering_before_ = ++gathering_;
  edge_seen_.resize(o_.point.size(), 0);
  edge_seen_[c.first] = gathering_;
  for (const OutlineVertex e : c.old_vertices()) edge_seen_[e] = gathering_;
  gather_along(before, epsilon_);
  before_ = {c.first, c.old, o_.edits, near_.size(), potential(before, c, ShortPath::kNowhere)};
  ++gathering_;
}

void ChangeJudge::gather_along(const ShortPath& path, double reach) {
  for (int j = 0; j < path.edges; ++j) {
    const Point2 a = path.at(j), b = path.at(j + 1);
    // The box of a long slanted edge holds much that is nowhere near it.
    const double slant = std::min(std::abs(b.x - a.x), std::abs(b.y - a.y));
    const int pieces = 1 + static_cast<int>(std::min(slant / (4 * reach), 1000.0));
    Point2 from = a;
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      const Point2 to{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      gather_in(grid::box_of(from, to).grown(reach));
      from = to;
    }
  }
}

void ChangeJudge::gather_in(const Bounds2& box) {
  o_.grid.visit_cells(box, [&](std::size_t cell) {
    if (is_seen(cell_seen_[cell])) return;
    bool all = true;
    o_.grid.visit_cell(cell, [&](OutlineVertex e) {
      std::uint32_t& seen = edge_seen_[e];
      if (is_seen(seen)) return;
      if (!grid::box_of(o_.at(e), o_.at(o_.after(e))).intersects(box)) {
        all = false;
        return;
      }
      seen = gathering_;
      near_.push_back(e);
    });
    if (all) cell_seen_[cell] = gathering_;
  });
}

/// Phi of the path, or, as soon as it is more than `most`, some other value above that.
double ChangeJudge::potential(const ShortPath& path, const OutlineChange& c, double most) const {
  double sum = 0;
  for (int j = 0; j < path.edges; ++j) {
    sum += weight(grid::squared_distance(path.at(j), path.at(j + 1)));
    for (int i = 0; i < path.count; ++i)
      if (i != j && i != j + 1) sum += weight(path.at(i), path.at(j), path.at(j + 1));
  }
  const OutlinePolygon polygon = o_.polygon_of(c.first);
  std::array<Bounds2, 3> boxes;
  for (int j = 0; j < path.edges; ++j)
    boxes[static_cast<std::size_t>(j)] = grid::box_of(path.at(j), path.at(j + 1)).grown(epsilon_);
  for (const OutlineVertex e : near_) {
    const Point2 a = o_.at(e), b = o_.at(o_.after(e));
    double pair = 0;
    if (e != c.last)
      for (int j = 0; j < path.edges; ++j)
        if (boxes[static_cast<std::size_t>(j)].contains(a))
          pair += weight(a, path.at(j), path.at(j + 1));
    const Bounds2 edge_box = grid::box_of(a, b).grown(epsilon_);
    for (int i = 1; i + 1 < path.count; ++i)
      if (edge_box.contains(path.at(i))) pair += weight(path.at(i), a, b);
    sum += o_.polygon_of(e) == polygon ? pair : kOtherPolygon * pair;
    if (sum > most) break;
  }
  return sum;
}

bool ChangeJudge::crosses(const ShortPath& path, const OutlineChange& c) const {
  for (int j = 0; j < path.edges; ++j) {
    const Point2 a = path.at(j), b = path.at(j + 1);
    if (a == b) return true;
    if (j + 2 <= path.edges && grid::folds_back(b, a, path.at(j + 2))) return true;
    if (j + 3 <= path.edges && grid::segments_touch(a, b, path.at(j + 2), path.at(j + 3)))
      return true;
  }
  for (const OutlineVertex e : near_) {
    const OutlineVertex f = o_.after(e);
    const Point2 p = o_.at(e), q = o_.at(f);
    for (int j = 0; j < path.edges; ++j) {
      const bool at_first = j == 0 && f == c.first;
      const bool at_last = j + 1 == path.edges && e == c.last;
      if (at_first && grid::folds_back(q, p, path.at(1))) return true;
      if (at_last && grid::folds_back(p, q, path.at(j))) return true;
      if (!at_first && !at_last && grid::segments_touch(path.at(j), path.at(j + 1), p, q))
        return true;
    }
  }
  return false;
}

bool ChangeJudge::sweeps_a_vertex(const ShortPath& before, const ShortPath& after,
                                  const OutlineChange& c) {
  Ring loop;
  for (int i = 0; i < before.count; ++i) loop.push_back(before.at(i));
  for (int i = after.count - 2; i > 0; --i) loop.push_back(after.at(i));
  // Points between the paths are within that of the old one, and within the inradius, which long
  // thin spikes have little of, of one of the two.
  const double reach = displacement(before, after);
  if (reach > epsilon_) {
    const double radius = most_inradius(loop) * (1 + 1e-9);
    if (radius > epsilon_) gather_along(before, std::min(reach, radius));
    if (radius > epsilon_ && radius < reach) gather_along(after, radius);
  }
  return std::any_of(near_.begin(), near_.end(), [&](OutlineVertex e) {
    return e != c.last && e != c.first && grid::is_inside(loop, o_.at(e));
  });
}

std::optional<double> ChangeJudge::gain(const OutlineChange& c, double least) {
  const OutlineRing ring = o_.ring_of(c.first);
  if (o_.size[ring] < c.old_count + 2 || o_.size[ring] - c.old_count + c.fresh_count < 3)
    return std::nullopt;
  for (const Point2 p : c.fresh_points())
    if (!keep_inside_.contains(p)) return std::nullopt;
  const ShortPath before = old_path(o_, c), after = new_path(o_, c);
  gather_before(before, c);
  if (before_.potential < least) return std::nullopt;
  gather_along(after, epsilon_);
  const double result =
      before_.potential - potential(after, c, before_.potential - least + kRounding);
  if (result < least || crosses(after, c) || sweeps_a_vertex(before, after, c)) return std::nullopt;
  return result;
}

}  // namespace tetropolis
