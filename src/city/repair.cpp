#include "city/repair.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>

#include "city/grid_geometry.h"

namespace tetropolis {

namespace {

using grid::distance;
using grid::point_segment_distance;
using grid::twice_area;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMinGain = 0.01;
constexpr double kMaxGain = 4;
constexpr double kOtherPolygon = 10;

enum class Kind : std::uint8_t { kDrop, kMerge, kSlide, kMove, kFill };

/// The vertices between `first` and `last` (both stay) are replaced by `fresh`.
struct Change {
  Kind kind = Kind::kDrop;
  std::int32_t first = -1;
  std::int32_t last = -1;
  std::array<std::int32_t, 2> old{-1, -1};
  int old_count = 0;
  std::array<Point2, 2> fresh{};
  int fresh_count = 0;
  double cost = 0;
  std::array<Point2, 4> made_for{};  ///< The points from first to last when it was considered.
};

struct Rated {
  Change change;
  double score = kInfinity;
};

/// At most four points: fixed, up to two free, fixed.
struct Path {
  std::array<Point2, 4> p{};
  int edges = 0;
  Bounds2 box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  void add(Point2 q) {
    p[static_cast<std::size_t>(count++)] = q;
    edges = count - 1;
    grid::extend(box, q);
  }
  Point2 at(int i) const { return p[static_cast<std::size_t>(i)]; }
  int count = 0;
};

class Repairer {
 public:
  Repairer(Outline& outline, const RepairOptions& options, RepairCounts& counts)
      : o_(outline),
        options_(options),
        counts_(counts),
        epsilon2_(options.epsilon * options.epsilon),
        seen_(outline.point.size(), 0),
        version_(outline.point.size(), 0),
        rated_(outline.point.size()) {}

  void repair();
  void tidy();

 private:
  struct Entry {
    double score;
    std::int32_t vertex;
    std::uint32_t version;
    bool operator<(const Entry& other) const {  // std::priority_queue keeps the largest on top
      return std::tie(other.score, other.vertex) < std::tie(score, vertex);
    }
  };

  double weight(double squared) const {
    return squared < epsilon2_ ? 1.1 - std::sqrt(squared) / options_.epsilon : 0;
  }
  double weight(Point2 p, Point2 a, Point2 b) const {
    return weight(grid::squared_distance_to_segment(p, a, b));
  }
  Path old_path(const Change& c) const;
  Path new_path(const Change& c) const;
  void gather(const Path& before, const Path& after, const Change& c);
  void gather_along(const Path& path, double reach);
  double potential(const Path& path, const Change& c) const;
  bool crosses(const Path& path, const Change& c) const;
  bool sweeps_a_vertex(const Path& before, const Path& after, const Change& c) const;
  std::optional<double> gain(const Change& c);

  void consider(const Change& c);
  void consider_drop(std::int32_t v);
  void consider_drop_pair(std::int32_t v);
  void consider_merge(std::int32_t v);
  void consider_slides(std::int32_t v);
  void consider_slide(const Change& base, Point2 v, Point2 w);
  void consider_move(std::int32_t v, Point2 q);
  void consider_moves_from(std::int32_t v, Point2 p);
  void consider_fill(std::int32_t v);
  bool rate(std::int32_t v);
  void queue(std::int32_t v);
  bool still_good(const Rated& rated);

  void apply(const Change& c);
  void fill(const Change& c);
  void touch_around(const Path& before, const Path& after, const Change& c);

  Outline& o_;
  const RepairOptions& options_;
  RepairCounts& counts_;
  double epsilon2_;
  std::vector<std::uint32_t> seen_;  ///< Per edge: the gathering it was last met in.
  std::uint32_t gathering_ = 0;
  std::vector<std::int32_t> near_;   ///< Edges around the change at hand, without those it removes.
  std::vector<std::uint32_t> version_;
  std::vector<Rated> rated_;  ///< Per vertex: the best change when it was last rated.
  std::priority_queue<Entry> queue_;
  std::vector<std::int32_t> touched_;
  Rated best_;
};

Path Repairer::old_path(const Change& c) const {
  Path path;
  path.add(o_.at(c.first));
  for (int i = 0; i < c.old_count; ++i) path.add(o_.at(c.old[static_cast<std::size_t>(i)]));
  path.add(o_.at(c.last));
  return path;
}

Path Repairer::new_path(const Change& c) const {
  Path path;
  path.add(o_.at(c.first));
  for (int i = 0; i < c.fresh_count; ++i) path.add(c.fresh[static_cast<std::size_t>(i)]);
  path.add(o_.at(c.last));
  return path;
}

/// Collects the edges within epsilon of either path or inside the region the change sweeps over.
/// Every point of that region is within the largest displacement of the old path.
void Repairer::gather(const Path& before, const Path& after, const Change& c) {
  near_.clear();
  ++gathering_;
  const auto mark = [&](std::int32_t e) { seen_[static_cast<std::size_t>(e)] = gathering_; };
  mark(c.first);
  for (int i = 0; i < c.old_count; ++i) mark(c.old[static_cast<std::size_t>(i)]);
  double displacement = 0;
  for (int i = 1; i + 1 < before.count; ++i) {
    double nearest = kInfinity;
    for (int j = 0; j < after.edges; ++j)
      nearest = std::min(nearest,
                         point_segment_distance(before.at(i), after.at(j), after.at(j + 1)));
    displacement = std::max(displacement, nearest);
  }
  for (int i = 1; i + 1 < after.count; ++i) {
    double nearest = kInfinity;
    for (int j = 0; j < before.edges; ++j)
      nearest = std::min(nearest,
                         point_segment_distance(after.at(i), before.at(j), before.at(j + 1)));
    displacement = std::max(displacement, nearest);
  }
  gather_along(before, std::max(options_.epsilon, displacement));
  gather_along(after, options_.epsilon);
}

void Repairer::gather_along(const Path& path, double reach) {
  for (int j = 0; j < path.edges; ++j) {
    const Point2 a = path.at(j), b = path.at(j + 1);
    // The box of a long slanted edge holds much that is nowhere near it.
    const double slant = std::min(std::abs(b.x - a.x), std::abs(b.y - a.y));
    const int pieces = 1 + static_cast<int>(std::min(slant / (4 * reach), 1000.0));
    Point2 from = a;
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      const Point2 to{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      const Bounds2 box = grid::box_of(from, to).grown(reach);
      o_.grid.visit(box, [&](std::int32_t e) {
        if (seen_[static_cast<std::size_t>(e)] == gathering_) return;
        if (!grid::box_of(o_.at(e), o_.at(o_.after(e))).intersects(box)) return;
        seen_[static_cast<std::size_t>(e)] = gathering_;
        near_.push_back(e);
      });
      from = to;
    }
  }
}

double Repairer::potential(const Path& path, const Change& c) const {
  double sum = 0;
  for (int j = 0; j < path.edges; ++j) {
    sum += weight(grid::squared_distance(path.at(j), path.at(j + 1)));
    for (int i = 0; i < path.count; ++i)
      if (i != j && i != j + 1) sum += weight(path.at(i), path.at(j), path.at(j + 1));
  }
  const std::int32_t group = o_.group_of(c.first);
  std::array<Bounds2, 3> boxes;
  for (int j = 0; j < path.edges; ++j)
    boxes[static_cast<std::size_t>(j)] =
        grid::box_of(path.at(j), path.at(j + 1)).grown(options_.epsilon);
  for (const std::int32_t e : near_) {
    const Point2 a = o_.at(e), b = o_.at(o_.after(e));
    double pair = 0;
    if (e != c.last)
      for (int j = 0; j < path.edges; ++j)
        if (boxes[static_cast<std::size_t>(j)].contains(a))
          pair += weight(a, path.at(j), path.at(j + 1));
    const Bounds2 edge_box = grid::box_of(a, b).grown(options_.epsilon);
    for (int i = 1; i + 1 < path.count; ++i)
      if (edge_box.contains(path.at(i))) pair += weight(path.at(i), a, b);
    sum += o_.group_of(e) == group ? pair : kOtherPolygon * pair;
  }
  return sum;
}

bool Repairer::crosses(const Path& path, const Change& c) const {
  for (int j = 0; j < path.edges; ++j) {
    const Point2 a = path.at(j), b = path.at(j + 1);
    if (a == b) return true;
    if (j + 2 <= path.edges && grid::folds_back(b, a, path.at(j + 2))) return true;
    if (j + 3 <= path.edges && grid::segments_touch(a, b, path.at(j + 2), path.at(j + 3)))
      return true;
  }
  for (const std::int32_t e : near_) {
    const std::int32_t f = o_.after(e);
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

bool Repairer::sweeps_a_vertex(const Path& before, const Path& after, const Change& c) const {
  Ring loop;
  for (int i = 0; i < before.count; ++i) loop.push_back(before.at(i));
  for (int i = after.count - 2; i > 0; --i) loop.push_back(after.at(i));
  const auto inside = [&](Point2 p) {
    bool odd = false;
    for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
      Point2 a = loop[j], b = loop[i];
      if ((a.y > p.y) == (b.y > p.y)) continue;
      if (a.y > b.y) std::swap(a, b);
      if (grid::orientation(a, b, p) > 0) odd = !odd;
    }
    return odd;
  };
  return std::any_of(near_.begin(), near_.end(), [&](std::int32_t e) {
    return e != c.last && e != c.first && inside(o_.at(e));
  });
}

std::optional<double> Repairer::gain(const Change& c) {
  const auto ring = static_cast<std::size_t>(o_.ring_of(c.first));
  if (o_.size[ring] < c.old_count + 2 || o_.size[ring] - c.old_count + c.fresh_count < 3)
    return std::nullopt;
  for (int i = 0; i < c.fresh_count; ++i)
    if (!options_.keep_inside.contains(c.fresh[static_cast<std::size_t>(i)])) return std::nullopt;
  const Path before = old_path(c), after = new_path(c);
  gather(before, after, c);
  const double result = potential(before, c) - potential(after, c);
  if (result < -1e-9 || crosses(after, c) || sweeps_a_vertex(before, after, c)) return std::nullopt;
  return result;
}

void Repairer::consider(const Change& c) {
  if (c.cost > options_.max_cost) return;
  // Gains count up to a limit, which gives an early way out for what cannot win.
  const double price = c.cost + 1e-3 * epsilon2_;
  if (price / kMaxGain >= best_.score) return;
  const std::optional<double> g = gain(c);
  if (!g || *g < kMinGain) return;
  const double score = price / std::min(*g, kMaxGain);
  if (score >= best_.score) return;
  best_ = {c, score};
  best_.change.made_for = old_path(c).p;
}

void Repairer::consider_drop(std::int32_t v) {
  Change c;
  c.first = o_.before(v);
  c.last = o_.after(v);
  c.old = {v, -1};
  c.old_count = 1;
  c.cost = twice_area(o_.at(c.first), o_.at(v), o_.at(c.last)) / 2;
  consider(c);
}

/// The change that replaces v and its successor, without fresh points.
Change pair_change(const Outline& o, std::int32_t v, Kind kind) {
  Change c;
  c.kind = kind;
  c.first = o.before(v);
  c.old = {v, o.after(v)};
  c.old_count = 2;
  c.last = o.after(c.old[1]);
  return c;
}

void Repairer::consider_drop_pair(std::int32_t v) {
  Change c = pair_change(o_, v, Kind::kDrop);
  const Point2 u = o_.at(c.first), a = o_.at(v), b = o_.at(c.old[1]), x = o_.at(c.last);
  // Two triangles that add up, or partly cancel where the chain crosses u-x.
  c.cost = (twice_area(u, a, b) + twice_area(u, b, x)) / 2;
  consider(c);
}

void Repairer::consider_merge(std::int32_t v) {
  Change c = pair_change(o_, v, Kind::kMerge);
  c.fresh_count = 1;
  const Point2 u = o_.at(c.first), a = o_.at(v), b = o_.at(c.old[1]), x = o_.at(c.last);
  const Point2 m = grid::rounded({(a.x + b.x) / 2, (a.y + b.y) / 2});
  c.fresh[0] = m;
  c.cost = (twice_area(u, a, m) + twice_area(m, b, x)) / 2;
  consider(c);
  // Where the two walls would meet if the short edge were not there.
  const double ux = a.x - u.x, uy = a.y - u.y, vx = b.x - x.x, vy = b.y - x.y;
  const double det = ux * vy - uy * vx;
  if (std::abs(det) < 0.05 * std::hypot(ux, uy) * std::hypot(vx, vy)) return;
  const double t = ((x.x - u.x) * vy - (x.y - u.y) * vx) / det;
  const Point2 q = grid::rounded({u.x + t * ux, u.y + t * uy});
  if (distance(q, a) > 3 * options_.epsilon || distance(q, b) > 3 * options_.epsilon) return;
  c.fresh[0] = q;
  c.cost = twice_area(a, q, b) / 2;
  consider(c);
}

void Repairer::consider_slide(const Change& base, Point2 v, Point2 w) {
  Change c = base;
  c.fresh = {grid::rounded(v), grid::rounded(w)};
  const Point2 a = o_.at(c.old[0]), b = o_.at(c.old[1]);
  const bool zigzag = grid::orientation(o_.at(c.first), a, b) *
                          grid::orientation(a, b, o_.at(c.last)) <
                      0;
  const double sum = (twice_area(a, c.fresh[0], b) + twice_area(c.fresh[0], b, c.fresh[1])) / 2;
  c.cost = zigzag && a != c.fresh[0] && b != c.fresh[1] ? sum / 2 : sum;
  consider(c);
}

void Repairer::consider_slides(std::int32_t v) {
  Change c = pair_change(o_, v, Kind::kSlide);
  c.fresh_count = 2;
  const Point2 u = o_.at(c.first), a = o_.at(v), b = o_.at(c.old[1]), x = o_.at(c.last);
  const double lu = distance(u, a), lx = distance(x, b);
  if (!(lu > 0 && lx > 0)) return;
  const double target = options_.epsilon + 1.5;
  // Smallest s > 0 with |(a - b) + d s| = target.
  const auto solve = [&](double dx, double dy) {
    const double qa = dx * dx + dy * dy, qb = (a.x - b.x) * dx + (a.y - b.y) * dy;
    const double qc = (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) - target * target;
    if (qa < 1e-6 || qc > 0) return -1.0;
    return (-qb + std::sqrt(qb * qb - qa * qc)) / qa;
  };
  const double ux = (u.x - a.x) / lu, uy = (u.y - a.y) / lu;
  const double xx = (x.x - b.x) / lx, xy = (x.y - b.y) / lx;
  const auto along_u = [&](double s) { return Point2{a.x + s * ux, a.y + s * uy}; };
  const auto along_x = [&](double s) { return Point2{b.x + s * xx, b.y + s * xy}; };
  const double both = solve(ux - xx, uy - xy);
  if (both > 0 && both < lu && both < lx) consider_slide(c, along_u(both), along_x(both));
  const double left = solve(ux, uy);
  if (left > 0 && left < lu) consider_slide(c, along_u(left), b);
  const double right = solve(-xx, -xy);
  if (right > 0 && right < lx) consider_slide(c, a, along_x(right));
}

void Repairer::consider_move(std::int32_t v, Point2 q) {
  Change c;
  c.kind = Kind::kMove;
  c.first = o_.before(v);
  c.last = o_.after(v);
  c.old = {v, -1};
  c.old_count = 1;
  c.fresh[0] = grid::rounded(q);
  c.fresh_count = 1;
  const Point2 p = o_.at(v);
  c.cost = (twice_area(o_.at(c.first), p, c.fresh[0]) + twice_area(c.fresh[0], p, o_.at(c.last))) / 2;
  consider(c);
}

void Repairer::consider_moves_from(std::int32_t v, Point2 p) {
  const Point2 a = o_.at(v);
  const double d = distance(a, p);
  if (!(d > 0)) return;
  const double shift = options_.epsilon + 1.5 - d;
  const double nx = (a.x - p.x) / d, ny = (a.y - p.y) / d;
  consider_move(v, {a.x + nx * shift, a.y + ny * shift});
  for (const std::int32_t w : {o_.before(v), o_.after(v)}) {
    const Point2 b = o_.at(w);
    const double length = distance(a, b);
    if (!(length > 0)) continue;
    const double tx = (a.x - b.x) / length, ty = (a.y - b.y) / length;
    const double rate_of_growth = tx * nx + ty * ny;
    if (std::abs(rate_of_growth) < 0.3) continue;
    const double t = shift / rate_of_growth;
    if (-t < length) consider_move(v, {a.x + t * tx, a.y + t * ty});
  }
}

void Repairer::consider_fill(std::int32_t v) {
  const auto ring = static_cast<std::size_t>(o_.ring_of(v));
  if (o_.is_hole[ring] == 0 || o_.size[ring] > 12) return;
  Ring hole;
  std::int32_t w = v;
  do {
    hole.push_back(o_.at(w));
    w = o_.after(w);
  } while (w != v);
  double twice = 0;
  for (std::size_t i = 1; i + 1 < hole.size(); ++i)
    twice += (hole[i].x - hole[0].x) * (hole[i + 1].y - hole[0].y) -
             (hole[i + 1].x - hole[0].x) * (hole[i].y - hole[0].y);
  Change c;
  c.kind = Kind::kFill;
  c.first = v;
  c.cost = std::abs(twice) / 2;
  const double e2 = options_.epsilon * options_.epsilon;
  if (c.cost > options_.max_cost || (hole.size() > 3 && c.cost > 4 * e2)) return;
  const double score = (c.cost + 1e-3 * e2) / 2;
  if (score < best_.score) best_ = {c, score};
}

bool Repairer::rate(std::int32_t v) {
  best_ = {};
  const Point2 p = o_.at(v);
  const std::int32_t u = o_.before(v), w = o_.after(v);
  const double eps = options_.epsilon;
  const bool short_before = distance(o_.at(u), p) < eps, short_after = distance(p, o_.at(w)) < eps;
  std::int32_t nearest = -1;
  double nearest_distance = eps;
  o_.grid.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(eps), [&](std::int32_t e) {
    if (e == v || e == u) return;
    // A neighbour on a short edge is not news.
    if ((e == w && short_after) || (o_.after(e) == u && short_before)) return;
    const double d = point_segment_distance(p, o_.at(e), o_.at(o_.after(e)));
    if (d < nearest_distance || (d == nearest_distance && e < nearest)) {
      nearest_distance = d;
      nearest = e;
    }
  });
  if (nearest < 0 && !short_before && !short_after) return false;
  consider_drop(v);
  consider_fill(v);
  if (short_before) {
    consider_drop(u);
    consider_drop_pair(u);
    consider_merge(u);
    consider_slides(u);
  }
  if (short_after) {
    consider_drop(w);
    consider_drop_pair(v);
    consider_merge(v);
    consider_slides(v);
  }
  if (nearest >= 0) {
    const std::int32_t end = o_.after(nearest);
    const Point2 a = o_.at(nearest), b = o_.at(end);
    const Point2 q = grid::nearest_on_segment(p, a, b);
    consider_drop(nearest);
    consider_drop(end);
    consider_moves_from(v, q);
    if (q == a) consider_moves_from(nearest, p);
    if (q == b) consider_moves_from(end, p);
  }
  return best_.score < kInfinity;
}

void Repairer::queue(std::int32_t v) {
  const std::uint32_t version = ++version_[static_cast<std::size_t>(v)];
  if (!rate(v)) return;
  rated_[static_cast<std::size_t>(v)] = best_;
  queue_.push({best_.score, v, version});
}

/// Whether a change rated earlier still has the vertices it was made for and the same gain.
bool Repairer::still_good(const Rated& rated) {
  const Change& c = rated.change;
  if (c.kind == Kind::kFill) {
    best_ = {};
    if (o_.alive(c.first)) consider_fill(c.first);
    return best_.score <= rated.score;
  }
  std::int32_t v = c.first;
  if (!o_.alive(v)) return false;
  for (int i = 0; i < c.old_count; ++i)
    if ((v = o_.after(v)) != c.old[static_cast<std::size_t>(i)]) return false;
  if (o_.after(v) != c.last) return false;
  const Path path = old_path(c);
  if (path.p != c.made_for) return false;
  const std::optional<double> g = gain(c);
  return g && *g >= kMinGain &&
         (c.cost + 1e-3 * epsilon2_) / std::min(*g, kMaxGain) <= rated.score * (1 + 1e-9);
}

void Repairer::repair() {
  for (std::int32_t v = 0; v < o_.vertex_count(); ++v)
    if (o_.alive(v)) queue(v);
  while (!queue_.empty()) {
    const Entry top = queue_.top();
    queue_.pop();
    if (!o_.alive(top.vertex) || version_[static_cast<std::size_t>(top.vertex)] != top.version)
      continue;
    const Rated rated = rated_[static_cast<std::size_t>(top.vertex)];
    if (!still_good(rated)) {
      queue(top.vertex);
      continue;
    }
    apply(rated.change);
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    const std::vector<std::int32_t> again = std::move(touched_);
    touched_.clear();
    for (const std::int32_t v : again)
      if (o_.alive(v)) queue(v);
  }
}

void Repairer::touch_around(const Path& before, const Path& after, const Change& c) {
  for (const std::int32_t v : {c.first, c.last, o_.before(c.first), o_.after(c.last)})
    touched_.push_back(v);
  for (int i = 0; i < c.old_count; ++i)
    touched_.push_back(c.old[static_cast<std::size_t>(i)]);
  for (const std::int32_t e : near_) {
    const std::int32_t f = o_.after(e);
    bool near = false;
    for (const Path* path : {&before, &after}) {
      for (int j = 0; j < path->edges; ++j)
        near = near || point_segment_distance(o_.at(e), path->at(j), path->at(j + 1)) <
                           options_.epsilon;
      for (int i = 1; i + 1 < path->count; ++i)
        near = near || point_segment_distance(path->at(i), o_.at(e), o_.at(f)) < options_.epsilon;
    }
    if (!near) continue;
    touched_.push_back(e);
    touched_.push_back(f);
  }
}

void Repairer::fill(const Change& c) {
  const auto ring = static_cast<std::size_t>(o_.ring_of(c.first));
  std::vector<std::int32_t> vertices;
  std::int32_t v = c.first;
  do {
    vertices.push_back(v);
    v = o_.after(v);
  } while (v != c.first);
  Bounds2 box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (const std::int32_t w : vertices) {
    grid::extend(box, o_.at(w));
    o_.grid.remove(w, o_.at(w), o_.at(o_.after(w)));
  }
  for (const std::int32_t w : vertices) o_.next[static_cast<std::size_t>(w)] = -1;
  o_.first[ring] = -1;
  o_.size[ring] = 0;
  ++counts_.filled;
  o_.grid.visit(box.grown(options_.epsilon), [&](std::int32_t e) {
    touched_.push_back(e);
    touched_.push_back(o_.after(e));
  });
}

void Repairer::apply(const Change& c) {
  const auto index = [](std::int32_t v) { return static_cast<std::size_t>(v); };
  o_.changed[index(o_.group_of(c.first))] = 1;
  if (c.kind == Kind::kFill) {
    fill(c);
    return;
  }
  const Path before = old_path(c), after = new_path(c);
  gather(before, after, c);

  std::int32_t v = c.first;
  for (int j = 0; j < before.edges; ++j) {
    o_.grid.remove(v, before.at(j), before.at(j + 1));
    v = o_.after(v);
  }
  const std::size_t ring = index(o_.ring_of(c.first));
  for (int i = 0; i < c.old_count; ++i) o_.next[index(c.old[static_cast<std::size_t>(i)])] = -1;
  v = c.first;
  for (int i = 0; i < c.fresh_count; ++i) {
    const std::int32_t w = c.old[static_cast<std::size_t>(i)];
    o_.point[index(w)] = c.fresh[static_cast<std::size_t>(i)];
    o_.next[index(v)] = w;
    o_.prev[index(w)] = v;
    v = w;
  }
  o_.next[index(v)] = c.last;
  o_.prev[index(c.last)] = v;
  o_.size[ring] += c.fresh_count - c.old_count;
  if (!o_.alive(o_.first[ring])) o_.first[ring] = c.last;
  v = c.first;
  for (int j = 0; j < after.edges; ++j) {
    o_.grid.insert(v, after.at(j), after.at(j + 1));
    v = o_.after(v);
  }
  switch (c.kind) {
    case Kind::kDrop: counts_.dropped += c.old_count; break;
    case Kind::kMerge: ++counts_.merged; break;
    case Kind::kSlide: ++counts_.slid; break;
    case Kind::kMove: ++counts_.moved; break;
    case Kind::kFill: break;
  }
  touch_around(before, after, c);
}

void Repairer::tidy() {
  const double tolerance = std::tan(options_.parallel_tolerance);
  const auto candidate = [&](std::int32_t v, Change& c) {
    c = {};
    c.first = o_.before(v);
    c.last = o_.after(v);
    c.old = {v, -1};
    c.old_count = 1;
    const Point2 u = o_.at(c.first), p = o_.at(v), w = o_.at(c.last);
    const double twice = twice_area(u, p, w), base = distance(u, w);
    const double along = (p.x - u.x) * (w.x - p.x) + (p.y - u.y) * (w.y - p.y);
    if (along <= 0 || twice > tolerance * along || twice > options_.max_shift * base) return kInfinity;
    return base > 0 ? twice / base : kInfinity;
  };
  std::vector<std::pair<double, std::int32_t>> order;
  Change c;
  for (std::int32_t v = 0; v < o_.vertex_count(); ++v)
    if (o_.alive(v))
      if (const double height = candidate(v, c); height < kInfinity) order.emplace_back(height, v);
  while (!order.empty()) {
    std::sort(order.begin(), order.end());
    touched_.clear();
    for (const auto& [height, v] : order) {
      if (!o_.alive(v) || candidate(v, c) == kInfinity || !gain(c)) continue;
      apply(c);
      --counts_.dropped;
      ++counts_.tidied;
    }
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    order.clear();
    for (const std::int32_t v : touched_)
      if (o_.alive(v))
        if (const double height = candidate(v, c); height < kInfinity && gain(c))
          order.emplace_back(height, v);
  }
  touched_.clear();
}

}  // namespace

void tidy_vertices(Outline& outline, const RepairOptions& options, RepairCounts& counts) {
  Repairer(outline, options, counts).tidy();
}

void repair_vertices(Outline& outline, const RepairOptions& options, RepairCounts& counts) {
  Repairer(outline, options, counts).repair();
}

std::vector<NearPair> near_pairs(const Outline& o, double epsilon) {
  std::vector<NearPair> pairs;
  for (std::int32_t v = 0; v < o.vertex_count(); ++v) {
    if (!o.alive(v)) continue;
    const std::size_t begin = pairs.size();
    const Point2 p = o.at(v);
    o.grid.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(epsilon), [&](std::int32_t e) {
      if (e == v || o.after(e) == v) return;
      const double d = point_segment_distance(p, o.at(e), o.at(o.after(e)));
      if (d < epsilon) pairs.push_back({v, e, d});
    });
    const auto from = pairs.begin() + static_cast<std::ptrdiff_t>(begin);
    std::sort(from, pairs.end(), [](const NearPair& a, const NearPair& b) { return a.edge < b.edge; });
    pairs.erase(std::unique(from, pairs.end(),
                            [](const NearPair& a, const NearPair& b) { return a.edge == b.edge; }),
                pairs.end());
  }
  return pairs;
}

}  // namespace tetropolis
