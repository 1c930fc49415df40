#include "climber.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "core/sort_once.h"
#include "core/units.h"
#include "geometry/vec3.h"
#include "volume/column/fill_columns.h"
#include "volume/quality/tet_cosines.h"

namespace tetropolis {

namespace {

// Found by trial, by the least angles and the numbers of cells: of Delft and of the survey's cities
// (scripts/survey).

/// Edges may become longer by so much for every metre above the lid.
constexpr double kGrowth = 0.35;

/// Share of that length that edges at a column have at most when it ends: the new ones are longer.
constexpr double kShortEnough = 0.7;

/// A column that is to end waits for its neighbours to climb: as if its next segment had its
/// midpoint so many spacings above.
constexpr double kWait = 0.9;

/// What cells (share_of) and faces are to be like where a column ends of its own accord.
constexpr double kGoodEnd = 1.5, kGoodEndFaces = 1.1;

/// And where one rises: otherwise it ends if that is better.
constexpr double kGoodRise = 1.4;

/// Least angles of triangles that cover the hole of a column, degrees: if it ends of its own accord
/// or as it cannot rise well.
constexpr double kLeastAngle = 22, kLeastAngleOfNeed = 15;

/// Lengths of segments that are tried, in spacings, the best guess first.
constexpr std::array kLengths{1.0, 1.2, 0.85, 1.5, 0.7, 0.6, 1.75, 0.5, 0.4};
constexpr double kLongest = 1.75;

/// More neighbours than this are not looked at in search of a cover.
constexpr std::size_t kMostNeighbours = 12;

/// Whether all angles of the triangle are above the one with this tangent, in plan.
bool is_wide(const Point3& a, const Point3& b, const Point3& c, double tangent) {
  const std::array<const Point3*, 3> p{&a, &b, &c};
  for (std::size_t i = 0; i < 3; ++i) {
    const Point3 &o = *p[i], &q = *p[(i + 1) % 3], &r = *p[(i + 2) % 3];
    const double along = (q[0] - o[0]) * (r[0] - o[0]) + (q[1] - o[1]) * (r[1] - o[1]);
    const double across = (q[0] - o[0]) * (r[1] - o[1]) - (q[1] - o[1]) * (r[0] - o[0]);
    if (!(across > 0 && across > tangent * along)) return false;
  }
  return true;
}

}  // namespace

/// The worst of some cells and faces.
class Worst {
 public:
  Worst() = default;
  explicit Worst(const RiseFigures& rise)
      : least_(rise.least), greatest_(rise.greatest), straight_(rise.straight) {}
  void add(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
    const TetCosines shape = tet_cosines(a, b, c, d);
    least_ = std::min(least_, shape.volume > 0 ? 1 - shape.greatest : 0);
    greatest_ = std::min(greatest_, 1 + shape.least);
  }
  /// Between cells with these centres.
  void add_face(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
    const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
    const Point3 d = minus(c1, c0);
    straight_ = std::min(straight_, std::abs(dot(n, d)) / std::sqrt(dot(n, n) * dot(d, d)));
  }
  /// About the least angle over kLeastOfMost, or 180 degrees less the greatest over what the floor
  /// leaves, or the cosine of non-orthogonality over that of kMostNonOrthogonal, whichever is less.
  double share() const {
    static const double few = versine(kLeastOfMost), flat = versine(180 - kQualityFloor.greatest);
    // Of flat cells the rounded figures may be negative.
    const double angles = std::sqrt(std::max(0.0, std::min(least_ / few, greatest_ / flat)));
    return std::min(angles, straight_ / straight());
  }
  bool is_below_floor() const {
    static const double least = versine(kQualityFloor.least);
    static const double flat = versine(180 - kQualityFloor.greatest);
    return least_ < least || greatest_ < flat || straight_ < straight();
  }

 private:
  static double versine(double degrees) { return 1 - std::cos(to_radians(degrees)); }
  static double straight() {
    static const double cosine = std::cos(to_radians(kMostNonOrthogonal));
    return cosine;
  }
  double least_ = 2, greatest_ = 2;  // 1 - cosine of the least angle, 1 + cosine of the greatest
  double straight_ = 1;              // cosine of the greatest non-orthogonality
};

/// The triangles around v, counter-clockwise; the oldest is the first, unless v is at the rim.
void Climber::find_star(VertexIndex v) {
  const std::vector<Neighbour>& around = front_.around[v];
  const std::size_t n = around.size() - (column(v).stays ? 1 : 0);
  std::size_t first = 0;
  for (std::size_t i = 1; i < n && !column(v).stays; ++i)
    if (triangle(around[i].piece).is_older(triangle(around[first].piece))) first = i;
  star_.clear();
  rows_.start(n);
  for (std::size_t k = 0, i = first; k < n; ++k) {
    const Neighbour& here = around[i];
    i = i + 1 < around.size() ? i + 1 : 0;
    star_.push_back({here.vertex, around[i].vertex, here.piece});
    rows_.set(k, at(here.vertex), at(around[i].vertex), triangle(here.piece).centre);
  }
}

/// Spacing as column_spacing() has it, in the front, and longest edge. Precondition: star_ is that
/// of v.
void Climber::measure_star(VertexIndex v) {
  const StarSizes sizes = rows_.sizes_around(at(v));
  column(v).spacing = shares_[v] * spacing_over(sizes.altitude, sizes.longest2);
  column(v).longest = std::sqrt(sizes.longest2);
}

bool Climber::may_end(VertexIndex v) const {
  return !column(v).stays && star_.size() <= kMostNeighbours;
}

double Climber::longest_edge(VertexIndex v) const {
  return column(v).edge + kGrowth * (column(v).at[2] - column(v).lid);
}

bool Climber::wants_to_end(VertexIndex v) const {
  return may_end(v) && column(v).longest < kShortEnough * longest_edge(v);
}

/// Precondition: the star of v is found and measured.
double Climber::key(VertexIndex v) const {
  return column(v).at[2] + column(v).spacing * (wants_to_end(v) ? kWait : 0.5);
}

void Climber::set_due(VertexIndex v) {
  if (!(at(v)[2] < front_.top) || front_.around[v].empty()) return;
  find_star(v);
  measure_star(v);
  front_.turns[v].due = key(v);
}

/// Quality, and the elevation to rise to. Near the top the rest is divided evenly.
std::pair<double, double> Climber::best_rise(VertexIndex v) {
  const double z = at(v)[2], wanted = column(v).spacing, left = front_.top - z;
  std::pair<double, double> best{0, front_.top};
  for (const double share : kLengths) {
    double to = z + share * wanted;
    if (left < 3 * share * wanted) {
      const double least = std::ceil(left / (kLongest * wanted));
      const double parts = std::max(least, std::round(left / (share * wanted)));
      to = parts > 1 ? z + left / parts : front_.top;
    }
    best = std::max(best, {worst_of_rise(v, to).share(), to});
    if (best.first >= kGoodRise) break;
  }
  return best;
}

Worst Climber::worst_of_rise(VertexIndex v, double to) {
  return Worst(rows_.measure_rise(at(v), to, star_.back().next == star_.front().vertex));
}

void Climber::rise(VertexIndex v, double to) {
  FrontColumn& own = column(v);
  add_step(v, to);
  for (const Spoke& spoke : star_) add_other(spoke.vertex);
  add_other(star_.back().next);
  const Point3 up{own.at[0], own.at[1], to};
  for (std::size_t i = 0; i < star_.size(); ++i) {
    const Spoke& spoke = star_[i];
    cover(spoke, v, static_cast<std::int32_t>(i));
    triangle(spoke.piece).centre = centre_of({own.at, at(spoke.vertex), at(spoke.next), up});
  }
  own.cells += done_.steps.back().cells();
  ++own.risen;
  own.at = up;
}

/// Covers the hole that v leaves, by triangles whose worst cell is as good as can be. Returns
/// false, with all as it was, if that is not better than `least_share`.
bool Climber::end(VertexIndex v, double least_share, double least_angle) {
  constexpr std::size_t kMost = kMostNeighbours;
  const std::size_t n = star_.size();
  const Point3 o = at(v);
  std::array<Point3, kMost> ring;
  const double longest = longest_edge(v), tangent = std::tan(to_radians(least_angle));
  for (std::size_t i = 0; i < n; ++i) ring[i] = at(star_[i].vertex);
  std::array<double, kMost * kMost> best;
  std::fill_n(best.begin(), n * n, kInfinity);
  std::array<std::size_t, kMost * kMost> split;  // where `best` is found
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      double most = least_share;  // What is not better does not help.
      for (std::size_t k = i + 1; k < j; ++k) {
        double q = std::min(best[i * n + k], best[k * n + j]);
        if (!(q > most)) continue;
        const Point3 &a = ring[i], &b = ring[k], &c = ring[j];
        if (!is_wide(a, b, c, tangent)) continue;
        const bool is_new = i > 0 || j + 1 < n;
        const double dx = a[0] - c[0], dy = a[1] - c[1];
        if (is_new && dx * dx + dy * dy > longest * longest) continue;
        Worst cell;  // under the triangle
        cell.add(o, a, b, c);
        q = std::min(q, cell.share());
        if (q > most) {
          most = q;
          split[i * n + j] = k;
        }
      }
      best[i * n + j] = most;
    }
  if (!(best[n - 1] > least_share)) return false;
  struct Cap {
    std::array<std::size_t, 3> ring;
    Point3 centre;
  };
  std::array<Cap, kMost> caps;
  std::size_t count = 0;
  std::array<std::int32_t, kMost> over{};  // per spoke: the cap over its triangle
  // Of each chord i - j, the cap on its far side.
  Worst worst;
  const auto visit = [&](const auto& self, std::size_t i, std::size_t j) -> std::ptrdiff_t {
    if (j == i + 1) return -1;
    const std::size_t k = split[i * n + j];
    worst.add(o, ring[i], ring[k], ring[j]);
    const Point3 centre = centre_of({o, ring[i], ring[k], ring[j]});
    std::array<std::ptrdiff_t, 2> behind{self(self, i, k), self(self, k, j)};
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t a = side == 0 ? i : k, b = side == 0 ? k : j;
      const Point3 other = behind[side] < 0 ? triangle(star_[a].piece).centre
                                            : caps[static_cast<std::size_t>(behind[side])].centre;
      if (behind[side] < 0) over[a] = static_cast<std::int32_t>(count);
      worst.add_face({o, ring[a], ring[b]}, other, centre);
    }
    caps[count] = {{i, k, j}, centre};
    return static_cast<std::ptrdiff_t>(count++);
  };
  visit(visit, 0, n - 1);
  worst.add_face({o, ring[n - 1], ring[0]}, triangle(star_[n - 1].piece).centre,
                 caps[count - 1].centre);
  if (!(worst.share() > std::min(kGoodEndFaces, least_share))) return false;
  over[n - 1] = static_cast<std::int32_t>(count) - 1;
  if (worst.is_below_floor()) add_poor(v);

  const double order = column(v).order;
  add_step(v, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < n; ++i) cover(star_[i], v, over[i]);
  std::array<CapCorners, kMost> covers;
  for (std::size_t i = 0; i < count; ++i) {
    triangle(star_[i].piece) = {static_cast<std::int32_t>(i), v, order, caps[i].centre, false};
    covers[i].piece = star_[i].piece;
    for (std::size_t c = 0; c < 3; ++c) {
      covers[i].vertices[c] = star_[caps[i].ring[c]].vertex;
      add_other(covers[i].vertices[c]);
    }
  }
  for (const Spoke& spoke : star_) close(spoke.vertex, v, std::span(covers).first(count));
  front_.around[v].clear();
  return true;
}

/// Has the caps at u around it where v was.
void Climber::close(VertexIndex u, VertexIndex v, std::span<const CapCorners> caps) {
  std::vector<Neighbour>& around = front_.around[u];
  if (around.empty()) return;  // It does again what it has done.
  column(u).longest = -1;
  auto place = std::find_if(around.begin(), around.end(),
                            [&](const Neighbour& other) { return other.vertex == v; });
  is_sound_ = is_sound_ && place != around.end();
  if (!is_sound_) return;
  Neighbour& before = place == around.begin() ? around.back() : *(place - 1);
  const VertexIndex last = place + 1 == around.end() ? around.front().vertex : (place + 1)->vertex;
  // The third corner of the cap to the left of the edge from u, and its piece.
  const auto beyond = [&](VertexIndex from) {
    for (const CapCorners& cap : caps)
      for (std::size_t c = 0; c < 3; ++c)
        if (cap.vertices[c] == u && cap.vertices[(c + 1) % 3] == from)
          return Neighbour{cap.vertices[(c + 2) % 3], cap.piece};
    is_sound_ = false;
    return Neighbour{last, kNoPiece};
  };
  Neighbour next = beyond(before.vertex);
  before.piece = next.piece;
  bool is_first = true;
  while (next.vertex != last) {
    const Neighbour after = beyond(next.vertex);
    const Neighbour other{next.vertex, after.piece};
    if (std::exchange(is_first, false))
      *place = other;
    else
      place = around.insert(place + 1, other);
    next = after;
  }
  if (is_first) around.erase(place);
}

/// What it has done before; only the pieces at columns that are told of it change.
void Climber::repeat(VertexIndex v, const FrontRecord::Step& step) {
  FrontColumn& own = column(v);
  const std::span<const VertexIndex> others = step.others();
  if (step.step->is_end()) {
    std::vector<CapCorners> caps;
    for (std::size_t i = 0; 3 * i < others.size(); ++i) {
      const std::array<VertexIndex, 3> c{others[3 * i], others[3 * i + 1], others[3 * i + 2]};
      caps.push_back({c, static_cast<Piece>(front_.triangles.size() + added_.size())});
      added_.push_back({static_cast<std::int32_t>(i), v, step.order,
                        centre_of({own.at, at(c[0]), at(c[1]), at(c[2])}), false});
    }
    std::vector<VertexIndex> ring(others.begin(), others.end());
    sort_once(ring);
    for (const VertexIndex u : ring) close(u, v, caps);
    return;
  }
  const Point3 up{own.at[0], own.at[1], step.step->to};
  for (std::size_t k = 0; k + 1 < others.size(); ++k) {
    const VertexIndex a = others[k], b = others[k + 1];
    // Of a triangle v - a - b, which a or b may be told of.
    Piece piece = kNoPiece;
    for (const Neighbour& other : front_.around[a])
      if (other.vertex == b) piece = other.piece;
    for (const Neighbour& other : front_.around[b])
      if (other.vertex == v) piece = other.piece;
    if (piece == kNoPiece) continue;
    FrontTriangle& below = triangle(piece);
    below.centre = centre_of({own.at, at(a), at(b), up});
    below.is_lid = false;
  }
  own.at = up;
  ++own.risen;
}

/// Its turn has come.
void Climber::go(VertexIndex v) {
  FrontColumn& own = column(v);
  Turn& turn = front_.turns[v];
  own.order = std::max(own.order, turn.due);
  find_star(v);
  if (own.longest < 0) measure_star(v);
  if (const double now = key(v); now > turn.due) {
    turn.due = now;
    return;
  }
  turn.due = kInfinity;
  if (wants_to_end(v) && end(v, kGoodEnd, kLeastAngle)) return;
  const auto [quality, to] = best_rise(v);
  if (quality < kGoodRise && may_end(v) && end(v, quality, kLeastAngleOfNeed)) return;
  if (quality < 1 && worst_of_rise(v, to).is_below_floor()) add_poor(v);
  rise(v, to);
  if (to < front_.top) turn.due = key(v);
}

void Climber::climb(VertexIndex first, std::int32_t phase) {
  const auto is_before = [&](VertexIndex a, VertexIndex b) {
    return std::pair(front_.turns[a].due, a) < std::pair(front_.turns[b].due, b);
  };
  const std::int32_t tile = front_.turns[first].tile;
  waiting_.assign(1, first);
  while (!waiting_.empty()) {
    const VertexIndex v = waiting_.back();
    const bool is_done = front_.turns[v].due == kInfinity;
    if (is_done || (waiting_.size() > 1 && !is_before(v, waiting_[waiting_.size() - 2]))) {
      waiting_.pop_back();
      continue;
    }
    VertexIndex next = v;
    bool is_held = false;
    for (const Neighbour& other : front_.around[v]) {
      is_held = is_held || front_.turns[other.vertex].tile != tile;
      if (is_held) break;
      if (is_before(other.vertex, next)) next = other.vertex;
    }
    if (is_held || front_.turns[next].held == phase) {
      front_.turns[v].held = phase;
      waiting_.pop_back();
    } else if (next == v) {
      go(v);
    } else {
      waiting_.push_back(next);
    }
  }
}

bool Climber::climb(std::span<const VertexIndex> columns, std::span<const VertexIndex> others,
                    const FrontRecord& record) {
  using Entry = std::pair<double, VertexIndex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto wait = [&](double due, VertexIndex v) {
    if (due < kInfinity) queue.emplace(due, v);
  };
  for (const VertexIndex v : columns) wait(front_.turns[v].due, v);
  std::vector<std::size_t> repeated(others.size(), 0);  // steps of each
  const auto wait_again = [&](std::size_t i) {
    const std::span<const FrontRecord::Step> steps = record.steps_of(others[i]);
    if (repeated[i] < steps.size()) wait(steps[repeated[i]].order, others[i]);
  };
  for (std::size_t i = 0; i < others.size(); ++i) wait_again(i);
  while (is_sound_ && !queue.empty()) {
    const VertexIndex v = queue.top().second;
    queue.pop();
    const auto found = std::lower_bound(others.begin(), others.end(), v);
    if (found != others.end() && *found == v) {
      const auto i = static_cast<std::size_t>(found - others.begin());
      repeat(v, record.steps_of(v)[repeated[i]++]);
      wait_again(i);
    } else {
      go(v);
      wait(front_.turns[v].due, v);
    }
  }
  return is_sound_;
}

}  // namespace tetropolis
