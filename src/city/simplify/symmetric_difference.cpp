#include "symmetric_difference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "city/edge_grid.h"
#include "city/grid_geometry.h"
#include "core/disjoint_sets.h"
#include "core/sort_once.h"

namespace tetropolis {

namespace {

using Segment = DifferenceEdge;

bool below(Point2 p, Point2 q) { return p.y < q.y || (p.y == q.y && p.x < q.x); }

bool before_in_order(const Segment& s, const Segment& t) {
  return below(s.a, t.a) || (s.a == t.a && below(s.b, t.b));
}

/// The edges that occur an odd number of times in both lists together.
std::vector<Segment> unshared(std::span<const Polygon> before, std::span<const Polygon> after) {
  std::vector<Segment> all;
  const auto add = [&](std::span<const Polygon> polygons, bool of_after) {
    for (const Polygon& polygon : polygons)
      for_each_edge(polygon, [&](Point2 a, Point2 b) {
        all.push_back(below(a, b) ? Segment{a, b, of_after, true} : Segment{b, a, of_after, false});
      });
  };
  add(before, false);
  add(after, true);
  std::sort(all.begin(), all.end(), before_in_order);
  std::vector<Segment> odd;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t j = i;
    while (j < all.size() && all[j].a == all[i].a && all[j].b == all[i].b) ++j;
    if ((j - i) % 2 == 1) odd.push_back(all[i]);
    i = j;
  }
  return odd;
}

/// Heights between which no segments of the piece (sorted) start, end or cross.
std::vector<double> slab_heights(const std::vector<Segment>& piece) {
  std::vector<double> heights;
  std::vector<std::size_t> active;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Segment& s = piece[i];
    heights.push_back(s.a.y);
    heights.push_back(s.b.y);
    std::erase_if(active, [&](std::size_t k) { return piece[k].b.y < s.a.y; });
    for (const std::size_t k : active) {
      const Segment& t = piece[k];
      if (!grid::segments_touch(s.a, s.b, t.a, t.b)) continue;
      const double ux = s.b.x - s.a.x, uy = s.b.y - s.a.y;
      const double vx = t.b.x - t.a.x, vy = t.b.y - t.a.y;
      const double det = ux * vy - uy * vx;
      if (det == 0) continue;
      heights.push_back(s.a.y + ((t.a.x - s.a.x) * vy - (t.a.y - s.a.y) * vx) / det * uy);
    }
    active.push_back(i);
  }
  sort_once(heights);
  return heights;
}

/// The mirror image at the line x = y.
Point2 mirrored(Point2 p) { return {p.y, p.x}; }
Segment mirrored(const Segment& s) {
  const Point2 a = mirrored(s.a), b = mirrored(s.b);
  if (below(a, b)) return {a, b, s.of_after, !s.interior_left};
  return {b, a, s.of_after, s.interior_left};
}

/// Where a segment passes the height y.
double x_at(const Segment& s, double y) {
  return s.a.x + (y - s.a.y) / (s.b.y - s.a.y) * (s.b.x - s.a.x);
}

/// Between two segments, by their numbers, and two heights.
struct Strip {
  double low, high;
  std::size_t left, right;
};

/// The strips of a piece, slab by slab. A strip goes on for as long as its sides do, so there are
/// no more of them than ends and crossings of segments.
class Strips {
 public:
  explicit Strips(std::size_t segments) : last_(segments, {kNone, kNone}) {}

  void add(const Strip& part) {
    auto& [strip, side] = last_[part.left];
    if (side == part.right && strips_[strip].high == part.low) {
      strips_[strip].high = part.high;
      return;
    }
    last_[part.left] = {strips_.size(), part.right};
    strips_.push_back(part);
  }
  const std::vector<Strip>& all() const { return strips_; }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<Strip> strips_;
  std::vector<std::pair<std::size_t, std::size_t>> last_;  // by left side: strip and right side
};

/// The segments of a piece (sorted) that reach through a slab, from left to right.
class Crossing {
 public:
  explicit Crossing(const std::vector<Segment>& piece) : piece_(piece) {}

  /// Precondition: slabs in ascending order.
  void move_to(double low, double middle) {
    std::erase_if(across_, [&](const auto& entry) { return piece_[entry.second].b.y <= low; });
    const auto old = static_cast<std::ptrdiff_t>(across_.size());
    for (; next_ < piece_.size() && piece_[next_].a.y <= low; ++next_)
      if (piece_[next_].b.y > low) across_.emplace_back(0.0, next_);
    for (auto& [x, k] : across_) x = x_at(piece_[k], middle);
    // From slab to slab the order stays as it is, but at crossings.
    const auto came = across_.begin() + old;
    if (!std::is_sorted(across_.begin(), came)) std::sort(across_.begin(), came);
    std::sort(came, across_.end());
    merged_.resize(across_.size());
    std::merge(across_.begin(), came, came, across_.end(), merged_.begin());
    across_.swap(merged_);
  }
  /// Where they pass the middle, and their numbers.
  const std::vector<std::pair<double, std::size_t>>& all() const { return across_; }

 private:
  const std::vector<Segment>& piece_;
  std::vector<std::pair<double, std::size_t>> across_, merged_;
  std::size_t next_ = 0;
};

/// Area bounded by a piece (sorted), even-odd, and the strips that it consists of.
double sweep(const std::vector<Segment>& piece, Strips& strips) {
  const std::vector<double> heights = slab_heights(piece);
  double sum = 0;
  Crossing crossing(piece);
  for (std::size_t h = 0; h + 1 < heights.size(); ++h) {
    const double low = heights[h], high = heights[h + 1];
    crossing.move_to(low, (low + high) / 2);
    const auto& across = crossing.all();
    for (std::size_t k = 0; k + 1 < across.size(); k += 2) {
      // Straight sides: the width in the middle is the mean width.
      const double width = across[k + 1].first - across[k].first;
      sum += width * (high - low);
      if (width > 0) strips.add({low, high, across[k].second, across[k + 1].second});
    }
  }
  return sum;
}

/// Area bounded by a piece, even-odd; adds its strips to `strips` if asked for.
double piece_area(std::vector<Segment> piece, std::vector<DifferenceStrip>* strips) {
  Bounds2 box = Bounds2::nothing();
  for (const Segment& s : piece) box.extend(grid::box_of(s.a, s.b));
  // Along the longer side, where few segments pass a height: along a row of houses, not across it.
  const bool is_wide = box.width() > box.height();
  if (is_wide) {
    for (Segment& s : piece) s = mirrored(s);
    std::sort(piece.begin(), piece.end(), before_in_order);
  }
  Strips found(piece.size());
  const double sum = sweep(piece, found);
  if (strips == nullptr) return sum;
  for (const Strip& strip : found.all()) {
    const Segment &left = piece[strip.left], &right = piece[strip.right];
    DifferenceStrip part{
        {Point2{x_at(left, strip.low), strip.low}, Point2{x_at(right, strip.low), strip.low},
         Point2{x_at(right, strip.high), strip.high}, Point2{x_at(left, strip.high), strip.high}},
        left,
        right,
        left.of_after == !left.interior_left};
    if (is_wide) {
      for (Point2& p : part.corners) p = mirrored(p);
      part.left = mirrored(left);
      part.right = mirrored(right);
    }
    strips->push_back(part);
  }
  return sum;
}

using Member = std::pair<LineIndex, LineIndex>;  // the root of a set, and what is in it

/// Set by set, each in order.
std::vector<Member> by_root(DisjointSets<LineIndex>& sets, std::size_t size) {
  std::vector<Member> order;
  for (const LineIndex i : indices<LineIndex>(size)) order.emplace_back(sets.root(i), i);
  std::sort(order.begin(), order.end());
  return order;
}

/// Joins pieces, the sets of segments that touch each other, to those that they lie inside: that
/// is not part of the difference twice, nor is what a strip covers, then.
void join_nested(const std::vector<Segment>& segments, const EdgeGrid& index, const Bounds2& box,
                 DisjointSets<LineIndex>& sets) {
  std::vector<Member> inside;  // pieces, and others around them
  std::vector<LineIndex> crossed;
  const std::vector<Member> order = by_root(sets, segments.size());
  for (std::size_t i = 0; i < order.size();) {
    const LineIndex root = order[i].first;
    // Other pieces do not touch this one, so all of it lies inside the same of them.
    Point2 p = segments[order[i].second].a;
    for (; i < order.size() && order[i].first == root; ++i) {
      const Segment& s = segments[order[i].second];
      for (const Point2 q : {s.a, s.b})
        if (q.x < p.x) p = q;
    }
    crossed.clear();
    index.visit({box.xmin, p.y, p.x, p.y}, [&](LineIndex k) {
      const Segment& s = segments[k];
      if (s.a.y <= p.y && s.b.y > p.y && grid::orientation(s.a, s.b, p) < 0) crossed.push_back(k);
    });
    sort_once(crossed);
    for (LineIndex& k : crossed) k = sets.root(k);
    std::sort(crossed.begin(), crossed.end());
    for (std::size_t k = 0; k < crossed.size();) {
      const auto [first, last] = std::equal_range(crossed.begin() + static_cast<std::ptrdiff_t>(k),
                                                  crossed.end(), crossed[k]);
      if ((last - first) % 2 == 1) inside.emplace_back(root, *first);
      k = static_cast<std::size_t>(last - crossed.begin());
    }
  }
  for (const auto& [piece, other] : inside) sets.join(piece, other);
}

}  // namespace

double symmetric_difference_area(std::span<const Polygon> before, std::span<const Polygon> after,
                                 std::vector<DifferenceStrip>* strips) {
  const std::vector<Segment> segments = unshared(before, after);
  if (segments.empty()) return 0;
  Bounds2 box = Bounds2::nothing();
  double length = 0;
  for (const Segment& s : segments) {
    box.extend(s.a);
    box.extend(s.b);
    length += grid::distance(s.a, s.b);
  }
  EdgeGrid index(box, cell_size(box, length, segments.size()) + 1, segments.size());
  DisjointSets<LineIndex> sets(segments.size());
  for (const LineIndex id : indices<LineIndex>(segments.size())) {
    const Segment& s = segments[id];
    index.visit(grid::box_of(s.a, s.b), [&](LineIndex k) {
      const Segment& t = segments[k];
      if (!sets.joined(id, k) && grid::segments_touch(s.a, s.b, t.a, t.b)) sets.join(id, k);
    });
    index.insert(id, s.a, s.b);
  }
  join_nested(segments, index, box, sets);
  double sum = 0;
  const std::vector<Member> order = by_root(sets, segments.size());
  for (std::size_t i = 0; i < order.size();) {
    std::vector<Segment> piece;
    const LineIndex root = order[i].first;
    for (; i < order.size() && order[i].first == root; ++i)
      piece.push_back(segments[order[i].second]);
    sum += piece_area(std::move(piece), strips);
  }
  return sum;
}

}  // namespace tetropolis
