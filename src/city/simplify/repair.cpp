#include "repair.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "core/infinity.h"
#include "core/sort_once.h"
#include "outline_change.h"

namespace tetropolis {

namespace {

using grid::distance;
using grid::point_segment_distance;
using grid::twice_area;

/// Least decrease of Phi, so that the search ends: a pair of one polygon weighs 0.1 to 1.1 (see
/// ChangeJudge), so this is a tenth of the least that undoing one gains.
constexpr double kMinGain = 0.01;
/// Gains beyond this count as this: it makes a bound on the score of a change known from its area
/// alone. About what four pairs of one polygon weigh.
constexpr double kMaxGain = 4;
/// Area in epsilon squared that every change costs on top of its own, so that among changes that
/// cost next to nothing the one that gains most comes first.
constexpr double kBaseCost = 1e-3;
/// Steps beyond epsilon that a distance is made: rounding moves each of two points by at most 0.71.
constexpr double kRoundingRoom = 1.5;
/// Walls that meet at less than 3 degrees have no meeting point worth a try.
constexpr double kLeastSine = 0.05;
/// How far from the ends of a short edge its walls may meet, in epsilon: at right angles they meet
/// within one.
constexpr double kFarthestMeeting = 3;
/// A vertex slides along a wall only if that takes it away from what it is near at this rate (17
/// degrees) or more; else it would have to go far for little.
constexpr double kLeastRate = 0.3;
/// Holes of more vertices or, but for triangles, more area (in epsilon squared) are courtyards to
/// keep.
constexpr std::int32_t kMostHoleVertices = 12;
constexpr double kMostHoleArea = 4;
/// Where a change touches more vertices than this, those with a change in the queue are rated anew
/// only when it is their turn: a vertex among thousands would be rated once for each of them.
constexpr std::size_t kCrowdOfDefects = 32;
/// Where it touches more than this, those without a change are put off until the queue is empty:
/// nearly none of them gets one, and each would be rated once for every change.
constexpr std::size_t kThrong = 256;

struct Rated {
  OutlineChange change;
  double score = kInfinity;
};

class Repairer {
 public:
  Repairer(Outline& outline, const RepairOptions& options, RepairCounts& counts)
      : o_(outline),
        options_(options),
        counts_(counts),
        epsilon2_(options.epsilon * options.epsilon),
        judge_(outline, options.epsilon, options.keep_inside),
        version_(outline.point.size(), 0),
        waits_(outline.point.size(), 0),
        is_put_off_(outline.point.size(), 0) {}

  void repair();
  void tidy();

 private:
  struct Entry {
    double score;
    OutlineVertex vertex;
    std::uint32_t version;
    bool operator<(const Entry& other) const {  // std::priority_queue keeps the largest on top
      return std::tie(other.score, other.vertex) < std::tie(score, vertex);
    }
  };

  void consider(const OutlineChange& c);
  void consider_drop(OutlineVertex v);
  void consider_drop_pair(OutlineVertex v);
  void consider_merge(OutlineVertex v);
  void consider_slides(OutlineVertex v);
  void consider_slide(const OutlineChange& base, Point2 v, Point2 w);
  void consider_move(OutlineVertex v, Point2 q);
  void consider_moves_from(OutlineVertex v, Point2 p);
  void consider_fill(OutlineVertex v);
  bool is_empty_courtyard(const Ring& hole, OutlinePolygon polygon) const;
  bool rate(OutlineVertex v);
  void queue(OutlineVertex v);
  void put_off(OutlineVertex v);
  void queue_put_off();
  void queue_touched();
  bool still_good(const Rated& rated);

  void apply(const OutlineChange& c);
  void fill(const OutlineChange& c);
  void touch_around(const ShortPath& before, const ShortPath& after, const OutlineChange& c);

  Outline& o_;
  const RepairOptions& options_;
  RepairCounts& counts_;
  double epsilon2_;
  ChangeJudge judge_;
  std::vector<std::uint32_t> version_;
  std::vector<std::uint8_t> waits_;       ///< Per vertex: whether its change is in the queue.
  std::vector<std::uint8_t> is_put_off_;  ///< Per vertex.
  std::vector<OutlineVertex> put_off_;
  /// Of vertices whose change is in the queue: the best when they were last rated. Few have one.
  std::unordered_map<std::int32_t, Rated> rated_;
  std::priority_queue<Entry> queue_;
  std::vector<OutlineVertex> touched_;
  Rated best_;
};

void Repairer::consider(const OutlineChange& c) {
  if (c.cost > options_.max_cost) return;
  // Gains count up to a limit, which gives an early way out for what cannot win.
  const double price = c.cost + kBaseCost * epsilon2_;
  if (price / kMaxGain >= best_.score) return;
  const double least = std::max(kMinGain, price / best_.score * (1 - 1e-9));
  const std::optional<double> g = judge_.gain(c, least);
  if (!g) return;
  const double score = price / std::min(*g, kMaxGain);
  if (score >= best_.score) return;
  best_ = {c, score};
  best_.change.made_for = old_path(o_, c).p;
}

void Repairer::consider_drop(OutlineVertex v) {
  OutlineChange c = vertex_change(o_, v, ChangeKind::kDrop);
  c.cost = twice_area(o_.at(c.first), o_.at(v), o_.at(c.last)) / 2;
  consider(c);
}

/// The change that replaces v and its successor, without fresh points.
OutlineChange pair_change(const Outline& o, OutlineVertex v, ChangeKind kind) {
  OutlineChange c;
  c.kind = kind;
  c.first = o.before(v);
  c.old = {v, o.after(v)};
  c.old_count = 2;
  c.last = o.after(c.old[1]);
  return c;
}

void Repairer::consider_drop_pair(OutlineVertex v) {
  OutlineChange c = pair_change(o_, v, ChangeKind::kDrop);
  const Point2 u = o_.at(c.first), a = o_.at(v), b = o_.at(c.old[1]), x = o_.at(c.last);
  // Two triangles that add up, or partly cancel where the chain crosses u-x.
  c.cost = (twice_area(u, a, b) + twice_area(u, b, x)) / 2;
  consider(c);
}

void Repairer::consider_merge(OutlineVertex v) {
  OutlineChange c = pair_change(o_, v, ChangeKind::kMerge);
  c.fresh_count = 1;
  const Point2 u = o_.at(c.first), a = o_.at(v), b = o_.at(c.old[1]), x = o_.at(c.last);
  const Point2 m = grid::rounded({(a.x + b.x) / 2, (a.y + b.y) / 2});
  c.fresh[0] = m;
  c.cost = (twice_area(u, a, m) + twice_area(m, b, x)) / 2;
  consider(c);
  // Where the two walls would meet if the short edge were not there.
  const double ux = a.x - u.x, uy = a.y - u.y, vx = b.x - x.x, vy = b.y - x.y;
  const double det = ux * vy - uy * vx;
  if (std::abs(det) < kLeastSine * std::hypot(ux, uy) * std::hypot(vx, vy)) return;
  const double t = ((x.x - u.x) * vy - (x.y - u.y) * vx) / det;
  const Point2 q = grid::rounded({u.x + t * ux, u.y + t * uy});
  const double farthest = kFarthestMeeting * options_.epsilon;
  if (distance(q, a) > farthest || distance(q, b) > farthest) return;
  c.fresh[0] = q;
  c.cost = twice_area(a, q, b) / 2;
  consider(c);
}

void Repairer::consider_slide(const OutlineChange& base, Point2 v, Point2 w) {
  OutlineChange c = base;
  c.fresh = {grid::rounded(v), grid::rounded(w)};
  const Point2 a = o_.at(c.old[0]), b = o_.at(c.old[1]);
  const bool zigzag =
      grid::orientation(o_.at(c.first), a, b) * grid::orientation(a, b, o_.at(c.last)) < 0;
  const double sum = (twice_area(a, c.fresh[0], b) + twice_area(c.fresh[0], b, c.fresh[1])) / 2;
  c.cost = zigzag && a != c.fresh[0] && b != c.fresh[1] ? sum / 2 : sum;
  consider(c);
}

void Repairer::consider_slides(OutlineVertex v) {
  OutlineChange c = pair_change(o_, v, ChangeKind::kSlide);
  c.fresh_count = 2;
  const Point2 u = o_.at(c.first), a = o_.at(v), b = o_.at(c.old[1]), x = o_.at(c.last);
  const double lu = distance(u, a), lx = distance(x, b);
  if (!(lu > 0 && lx > 0)) return;
  const double target = options_.epsilon + kRoundingRoom;
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

void Repairer::consider_move(OutlineVertex v, Point2 q) {
  OutlineChange c = vertex_change(o_, v, ChangeKind::kMove);
  c.fresh[0] = grid::rounded(q);
  c.fresh_count = 1;
  const Point2 p = o_.at(v);
  c.cost =
      (twice_area(o_.at(c.first), p, c.fresh[0]) + twice_area(c.fresh[0], p, o_.at(c.last))) / 2;
  consider(c);
}

void Repairer::consider_moves_from(OutlineVertex v, Point2 p) {
  const Point2 a = o_.at(v);
  const double d = distance(a, p);
  if (!(d > 0)) return;
  const double shift = options_.epsilon + kRoundingRoom - d;
  const double nx = (a.x - p.x) / d, ny = (a.y - p.y) / d;
  consider_move(v, {a.x + nx * shift, a.y + ny * shift});
  for (const OutlineVertex w : {o_.before(v), o_.after(v)}) {
    const Point2 b = o_.at(w);
    const double length = distance(a, b);
    if (!(length > 0)) continue;
    const double tx = (a.x - b.x) / length, ty = (a.y - b.y) / length;
    const double rate_of_growth = tx * nx + ty * ny;
    if (std::abs(rate_of_growth) < kLeastRate) continue;
    const double t = shift / rate_of_growth;
    if (-t < length) consider_move(v, {a.x + t * tx, a.y + t * ty});
  }
}

/// Whether no other polygon stands in a hole of this one: no edges cross, so any of its vertices
/// would be inside.
bool Repairer::is_empty_courtyard(const Ring& hole, OutlinePolygon polygon) const {
  bool empty = true;
  o_.grid.visit(bounds(hole), [&](OutlineVertex e) {
    if (empty && o_.polygon_of(e) != polygon) empty = !grid::is_inside(hole, o_.at(e));
  });
  return empty;
}

void Repairer::consider_fill(OutlineVertex v) {
  const OutlineRing ring = o_.ring_of(v);
  if (o_.is_hole[ring] == 0 || o_.size[ring] > kMostHoleVertices) return;
  const Ring hole = ring_through(o_, v);
  OutlineChange c;
  c.kind = ChangeKind::kFill;
  c.first = v;
  c.cost = std::abs(signed_area(hole));
  if (c.cost > options_.max_cost) return;
  if (hole.size() > 3 && c.cost > kMostHoleArea * epsilon2_) return;
  // Its gain is not computed: it is taken as that of two pairs.
  const double score = (c.cost + kBaseCost * epsilon2_) / 2;
  if (score < best_.score && is_empty_courtyard(hole, o_.polygon_of(v))) best_ = {c, score};
}

bool Repairer::rate(OutlineVertex v) {
  best_ = {};
  const Point2 p = o_.at(v);
  const OutlineVertex u = o_.before(v), w = o_.after(v);
  const double eps = options_.epsilon;
  const bool short_before = distance(o_.at(u), p) < eps, short_after = distance(p, o_.at(w)) < eps;
  OutlineVertex nearest = kNoOutlineVertex;
  double nearest_distance = eps;
  o_.grid.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(eps), [&](OutlineVertex e) {
    if (e == v || e == u) return;
    // A neighbour on a short edge is not news.
    if ((e == w && short_after) || (o_.after(e) == u && short_before)) return;
    const double d = point_segment_distance(p, o_.at(e), o_.at(o_.after(e)));
    if (d < nearest_distance || (d == nearest_distance && e < nearest)) {
      nearest_distance = d;
      nearest = e;
    }
  });
  if (!nearest.valid() && !short_before && !short_after) return false;
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
  if (nearest.valid()) {
    const OutlineVertex end = o_.after(nearest);
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

void Repairer::queue(OutlineVertex v) {
  const std::uint32_t version = ++version_[v];
  const bool found = rate(v);
  waits_[v] = found ? 1 : 0;
  if (!found) return;
  rated_[v.value()] = best_;
  queue_.push({best_.score, v, version});
}

/// Whether a change rated earlier still has the vertices it was made for and the same gain.
bool Repairer::still_good(const Rated& rated) {
  const OutlineChange& c = rated.change;
  if (c.kind == ChangeKind::kFill) {
    best_ = {};
    if (o_.alive(c.first)) consider_fill(c.first);
    return best_.score <= rated.score;
  }
  OutlineVertex v = c.first;
  if (!o_.alive(v)) return false;
  for (const OutlineVertex old : c.old_vertices())
    if ((v = o_.after(v)) != old) return false;
  if (o_.after(v) != c.last) return false;
  const ShortPath path = old_path(o_, c);
  if (path.p != c.made_for) return false;
  const std::optional<double> g = judge_.gain(c, kMinGain);
  return g && (c.cost + kBaseCost * epsilon2_) / std::min(*g, kMaxGain) <= rated.score * (1 + 1e-9);
}

void Repairer::put_off(OutlineVertex v) {
  std::uint8_t& is_put_off = is_put_off_[v];
  if (is_put_off == 0) put_off_.push_back(v);
  is_put_off = 1;
}

void Repairer::queue_put_off() {
  for (const OutlineVertex v : put_off_) {
    is_put_off_[v] = 0;
    if (o_.alive(v)) queue(v);
  }
  put_off_.clear();
}

void Repairer::queue_touched() {
  sort_once(touched_);
  const std::vector<OutlineVertex> again = std::move(touched_);
  touched_.clear();
  const bool is_crowd = again.size() > kCrowdOfDefects, is_throng = again.size() > kThrong;
  for (const OutlineVertex v : again) {
    if (!o_.alive(v)) continue;
    const bool waits = waits_[v] != 0;
    if (is_throng && !waits) {
      put_off(v);
    } else if (!(is_crowd && waits)) {
      queue(v);
    }
  }
}

void Repairer::repair() {
  for (const OutlineVertex v : o_.vertices())
    if (o_.alive(v)) queue(v);
  while (!queue_.empty()) {
    const Entry top = queue_.top();
    queue_.pop();
    const OutlineVertex v = top.vertex;
    if (o_.alive(v) && version_[v] == top.version) {
      waits_[v] = 0;
      const Rated rated = std::move(rated_.at(v.value()));
      rated_.erase(v.value());
      if (still_good(rated)) {
        apply(rated.change);
        queue_touched();
      } else {
        queue(v);
      }
    }
    if (queue_.empty()) queue_put_off();
  }
}

void Repairer::touch_around(const ShortPath& before, const ShortPath& after,
                            const OutlineChange& c) {
  for (const OutlineVertex v : {c.first, c.last, o_.before(c.first), o_.after(c.last)})
    touched_.push_back(v);
  for (const OutlineVertex v : c.old_vertices()) touched_.push_back(v);
  for (const OutlineVertex e : judge_.near()) {
    const OutlineVertex f = o_.after(e);
    bool near = false;
    for (const ShortPath* path : {&before, &after}) {
      for (int j = 0; j < path->edges; ++j)
        near = near ||
               point_segment_distance(o_.at(e), path->at(j), path->at(j + 1)) < options_.epsilon;
      for (int i = 1; i + 1 < path->count; ++i)
        near = near || point_segment_distance(path->at(i), o_.at(e), o_.at(f)) < options_.epsilon;
    }
    if (!near) continue;
    touched_.push_back(e);
    touched_.push_back(f);
  }
}

void Repairer::fill(const OutlineChange& c) {
  const OutlineRing ring = o_.ring_of(c.first);
  std::vector<OutlineVertex> vertices;
  OutlineVertex v = c.first;
  do {
    vertices.push_back(v);
    v = o_.after(v);
  } while (v != c.first);
  Bounds2 box = Bounds2::nothing();
  for (const OutlineVertex w : vertices) {
    box.extend(o_.at(w));
    o_.grid.remove(w, o_.at(w), o_.at(o_.after(w)));
  }
  for (const OutlineVertex w : vertices) o_.next[w] = kNoOutlineVertex;
  ++o_.edits;
  o_.first[ring] = kNoOutlineVertex;
  o_.size[ring] = 0;
  ++counts_.filled;
  o_.grid.visit(box.grown(options_.epsilon), [&](OutlineVertex e) {
    touched_.push_back(e);
    touched_.push_back(o_.after(e));
  });
}

void Repairer::apply(const OutlineChange& c) {
  if (c.kind == ChangeKind::kFill) {
    o_.changed[o_.polygon_of(c.first)] = 1;
    fill(c);
    return;
  }
  const ShortPath before = old_path(o_, c), after = new_path(o_, c);
  judge_.gather(before, after, c);
  replace_vertices(o_, c);
  switch (c.kind) {
    case ChangeKind::kDrop:
      counts_.dropped += c.old_count;
      break;
    case ChangeKind::kMerge:
      ++counts_.merged;
      break;
    case ChangeKind::kSlide:
      ++counts_.slid;
      break;
    case ChangeKind::kMove:
      ++counts_.moved;
      break;
    case ChangeKind::kFill:
      break;
  }
  touch_around(before, after, c);
}

void Repairer::tidy() {
  const double tolerance = std::tan(options_.parallel_tolerance);
  const auto candidate = [&](OutlineVertex v, OutlineChange& c) {
    c = vertex_change(o_, v, ChangeKind::kDrop);
    const Point2 u = o_.at(c.first), p = o_.at(v), w = o_.at(c.last);
    const double twice = twice_area(u, p, w), base = distance(u, w);
    const double along = (p.x - u.x) * (w.x - p.x) + (p.y - u.y) * (w.y - p.y);
    if (along <= 0 || twice > tolerance * along || twice > options_.max_shift * base)
      return kInfinity;
    return base > 0 ? twice / base : kInfinity;
  };
  std::vector<std::pair<double, OutlineVertex>> order;
  OutlineChange c;
  for (const OutlineVertex v : o_.vertices())
    if (o_.alive(v))
      if (const double height = candidate(v, c); height < kInfinity) order.emplace_back(height, v);
  while (!order.empty()) {
    std::sort(order.begin(), order.end());
    touched_.clear();
    for (const auto& [height, v] : order) {
      if (!o_.alive(v) || candidate(v, c) == kInfinity || !judge_.gain(c)) continue;
      apply(c);
      --counts_.dropped;  // it is no repair
    }
    sort_once(touched_);
    order.clear();
    for (const OutlineVertex v : touched_)
      if (o_.alive(v))
        if (const double height = candidate(v, c); height < kInfinity && judge_.gain(c))
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
  for (const OutlineVertex v : o.vertices()) {
    if (!o.alive(v)) continue;
    const std::size_t begin = pairs.size();
    const Point2 p = o.at(v);
    o.grid.visit(Bounds2{p.x, p.y, p.x, p.y}.grown(epsilon), [&](OutlineVertex e) {
      if (e == v || o.after(e) == v) return;
      const double d = point_segment_distance(p, o.at(e), o.at(o.after(e)));
      if (d < epsilon) pairs.push_back({v, e, d});
    });
    const auto from = pairs.begin() + static_cast<std::ptrdiff_t>(begin);
    std::sort(from, pairs.end(),
              [](const NearPair& a, const NearPair& b) { return a.edge < b.edge; });
    pairs.erase(std::unique(from, pairs.end(),
                            [](const NearPair& a, const NearPair& b) { return a.edge == b.edge; }),
                pairs.end());
  }
  return pairs;
}

}  // namespace tetropolis
