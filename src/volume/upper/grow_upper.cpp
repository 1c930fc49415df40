#include "grow_upper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "core/infinity.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "volume/column/fill_columns.h"
#include "volume/column/upper_faces.h"
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

/// Where the best is below the floor, it is all done again with segments shorter by this factor at
/// that column and beside it, so often at most.
constexpr double kShorter = 0.85;
constexpr int kMostRounds = 6;

/// Least angles of triangles that cover the hole of a column, degrees: if it ends of its own accord
/// or as it cannot rise well.
constexpr double kLeastAngle = 22, kLeastAngleOfNeed = 15;

/// Lengths of segments that are tried, in spacings, the best guess first.
constexpr std::array kLengths{1.0, 1.2, 0.85, 1.5, 0.7, 0.6, 1.75, 0.5, 0.4};
constexpr double kLongest = 1.75;

/// More neighbours than this are not looked at in search of a cover.
constexpr std::size_t kMostNeighbours = 12;

/// The worst of some cells and faces.
class Worst {
 public:
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

using Front = std::int32_t;  // a triangle of the front

class Grower {
 public:
  /// `shares`: per vertex, of the spacing that segments are to have.
  Grower(const ColumnMesh& mesh, double top, std::span<const double> shares);
  UpperMesh grow();
  /// Vertices at which cells came below the floor, and those beside them.
  const std::vector<VertexIndex>& poor() const { return poor_; }

 private:
  struct Piece {
    std::array<VertexIndex, 3> corners;
    Point3 centre;  // of the cell below
    CellIndex cell;
  };
  /// A triangle around a vertex, from which it is to the left of the edge from `vertex` to `next`.
  struct Spoke {
    VertexIndex vertex, next;
    Front piece;
  };
  const Piece& piece_of(const Spoke& spoke) const {
    return pieces_[static_cast<std::size_t>(spoke.piece)];
  }
  Point3 at(VertexIndex v) const {
    const Point2 p = mesh_.ground.vertices[v];
    return {p.x, p.y, z_[v]};
  }
  void find_star(VertexIndex v);
  double spacing(VertexIndex v) const;
  double key(VertexIndex v) const;
  bool may_end(VertexIndex v) const { return stays_[v] == 0 && star_.size() <= kMostNeighbours; }
  /// That it may have now.
  double longest_edge(VertexIndex v) const { return edge_[v] + kGrowth * (z_[v] - lid_[v]); }
  bool wants_to_end(VertexIndex v) const;
  std::pair<double, double> best_rise(VertexIndex v) const;
  Worst worst_of_rise(VertexIndex v, double to) const;
  void rise(VertexIndex v, double to);
  bool end(VertexIndex v, double least, double least_angle);
  CellIndex add_cell(const std::array<NodeIndex, 4>& nodes);
  /// The cell will lie on this piece.
  void cover(Front piece, CellIndex cell) {
    const auto p = static_cast<std::size_t>(piece);
    if (pieces_[p].cell < first_cell_) upper_.over_lid[p] = cell;
  }

  const ColumnMesh& mesh_;
  double top_;
  std::span<const double> shares_;
  std::int64_t first_cell_;
  // Per vertex: elevations of front and lid, the longest edge on the lid, the front's node.
  std::vector<double> z_, lid_, edge_;
  std::vector<NodeIndex> node_;
  std::vector<std::uint8_t> stays_;         // at the rim
  std::vector<Piece> pieces_;               // the front, by triangle of the ground mesh at first
  std::vector<std::vector<Front>> around_;  // per vertex; none where its column has ended
  std::vector<Spoke> star_;                 // of the vertex that is looked at
  UpperMesh upper_;
  std::vector<VertexIndex> poor_;
};

Grower::Grower(const ColumnMesh& mesh, double top, std::span<const double> shares)
    : mesh_(mesh), top_(top), shares_(shares) {
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  first_cell_ = cells.back().value();
  const std::size_t count = mesh.vertex_count();
  z_.resize(count);
  lid_.resize(count);
  edge_.assign(count, 0.0);
  node_.resize(count);
  stays_.assign(count, 0);
  around_.resize(count);
  upper_.over_lid.assign(mesh.triangle_count(), kNoCell);
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    node_[v] = mesh.top(v);
    z_[v] = lid_[v] = mesh.z[mesh.top(v)];
  }
  for (const EdgeIndex e : mesh.edges.vertices.indices()) {
    const auto [a, b] = mesh.edges.vertices[e];
    const Point2 p = mesh.ground.vertices[a], q = mesh.ground.vertices[b];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    for (const VertexIndex v : {a, b}) {
      edge_[v] = std::max(edge_[v], length);
      if (mesh.edges.triangles[e][1] == kNoTriangle) stays_[v] = 1;
    }
  }
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const auto& v = mesh.ground.triangles[t];
    for (const VertexIndex u : v) around_[u].push_back(static_cast<Front>(pieces_.size()));
    pieces_.push_back({v, centre_of(uppermost_cell(mesh, t)), cells[t + 1] - 1});
  }
}

/// The triangles around v, counter-clockwise.
void Grower::find_star(VertexIndex v) {
  star_.clear();
  for (const Front f : around_[v]) {
    const auto& c = pieces_[static_cast<std::size_t>(f)].corners;
    const std::size_t i = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    star_.push_back({c[(i + 1) % 3], c[(i + 2) % 3], f});
  }
  // At the rim the first is the one that no other leads to.
  for (std::size_t i = 0; i < star_.size(); ++i) {
    const auto leads = [&](const Spoke& spoke) { return spoke.next == star_[i].vertex; };
    if (std::none_of(star_.begin(), star_.end(), leads)) {
      std::swap(star_[0], star_[i]);
      break;
    }
  }
  for (std::size_t i = 1; i < star_.size(); ++i)
    for (std::size_t j = i; j < star_.size(); ++j)
      if (star_[j].vertex == star_[i - 1].next) {
        std::swap(star_[i], star_[j]);
        break;
      }
}

/// As column_spacing() has it, in the front. Precondition: star_ is that of v.
double Grower::spacing(VertexIndex v) const {
  const Point2 o = mesh_.ground.vertices[v];
  double longest2 = 0, altitude = kInfinity;
  for (const Spoke& spoke : star_) {
    const Point2 p = mesh_.ground.vertices[spoke.vertex], q = mesh_.ground.vertices[spoke.next];
    const auto square = [](Point2 a, Point2 b) {
      return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
    };
    const double op = square(o, p), oq = square(o, q), pq = square(p, q);
    const double area = (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
    altitude = std::min(altitude, area / std::sqrt(std::max({op, oq, pq})));
    longest2 = std::max({longest2, op, oq});
  }
  return shares_[v] * spacing_over(altitude, longest2);
}

bool Grower::wants_to_end(VertexIndex v) const {
  if (!may_end(v)) return false;
  const Point2 o = mesh_.ground.vertices[v];
  double longest = 0;
  for (const Spoke& spoke : star_) {
    const Point2 p = mesh_.ground.vertices[spoke.vertex];
    longest = std::max(longest, std::hypot(p.x - o.x, p.y - o.y));
  }
  return longest < kShortEnough * longest_edge(v);
}

double Grower::key(VertexIndex v) const {
  if (!(z_[v] < top_)) return kInfinity;
  const double s = spacing(v);
  return z_[v] + s * (wants_to_end(v) ? kWait : 0.5);
}

/// Quality, and the elevation to rise to. Near the top the rest is divided evenly.
std::pair<double, double> Grower::best_rise(VertexIndex v) const {
  const double wanted = spacing(v), left = top_ - z_[v];
  std::pair<double, double> best{0, top_};
  for (const double share : kLengths) {
    double to = z_[v] + share * wanted;
    if (left < 3 * share * wanted) {
      const double least = std::ceil(left / (kLongest * wanted));
      const double parts = std::max(least, std::round(left / (share * wanted)));
      to = parts > 1 ? z_[v] + left / parts : top_;
    }
    best = std::max(best, {worst_of_rise(v, to).share(), to});
    if (best.first >= kGoodRise) break;
  }
  return best;
}

Worst Grower::worst_of_rise(VertexIndex v, double to) const {
  Worst worst;
  const Point3 p = at(v);
  const Point3 up{p[0], p[1], to};
  Point3 first{}, last{};
  for (const Spoke& spoke : star_) {
    const Point3 a = at(spoke.vertex), b = at(spoke.next);
    worst.add(p, a, b, up);
    const Point3 centre = centre_of({p, a, b, up});
    worst.add_face({p, a, b}, piece_of(spoke).centre, centre);
    if (&spoke == &star_.front())
      first = centre;
    else
      worst.add_face({p, a, up}, last, centre);
    last = centre;
  }
  if (star_.back().next == star_.front().vertex)
    worst.add_face({p, at(star_.front().vertex), up}, last, first);
  return worst;
}

CellIndex Grower::add_cell(const std::array<NodeIndex, 4>& nodes) {
  upper_.cells.push_back(nodes);
  return CellIndex(first_cell_ + static_cast<std::int64_t>(upper_.cells.size()) - 1);
}

void Grower::rise(VertexIndex v, double to) {
  const Point3 p = at(v);
  Point3 up = p;
  up[2] = to;
  const NodeIndex node(mesh_.column_nodes() + static_cast<std::int64_t>(upper_.points.size()));
  upper_.points.push_back(up);
  upper_.vertex.push_back(v);
  for (const Spoke& spoke : star_) {
    Piece& piece = pieces_[static_cast<std::size_t>(spoke.piece)];
    const CellIndex cell = add_cell({node_[v], node_[spoke.vertex], node_[spoke.next], node});
    cover(spoke.piece, cell);
    piece.cell = cell;
    piece.centre = centre_of({p, at(spoke.vertex), at(spoke.next), up});
  }
  node_[v] = node;
  z_[v] = to;
}

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

/// Covers the hole that v leaves, by triangles whose worst cell is as good as can be. Returns
/// false, with all as it was, if that is not better than `least_share`.
bool Grower::end(VertexIndex v, double least_share, double least_angle) {
  const std::size_t n = star_.size();
  const Point3 o = at(v);
  std::vector<Point3> ring(n);
  const double longest = longest_edge(v), tangent = std::tan(to_radians(least_angle));
  for (std::size_t i = 0; i < n; ++i) ring[i] = at(star_[i].vertex);
  std::vector<double> best(n * n, kInfinity);
  std::vector<std::size_t> split(n * n, 0);
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      double most = 0;
      for (std::size_t k = i + 1; k < j; ++k) {
        double q = std::min(best[i * n + k], best[k * n + j]);
        if (!(q > most)) continue;
        const Point3 &a = ring[i], &b = ring[k], &c = ring[j];
        if (!is_wide(a, b, c, tangent)) continue;
        const bool is_new = i > 0 || j + 1 < n;
        if (is_new && std::hypot(a[0] - c[0], a[1] - c[1]) > longest) continue;
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
  std::vector<Cap> caps;
  std::vector<std::size_t> over(n);  // per spoke: the cap over its triangle
  // Of each chord i - j, the cap on its far side.
  Worst worst;
  const auto visit = [&](const auto& self, std::size_t i, std::size_t j) -> std::ptrdiff_t {
    if (j == i + 1) return -1;
    const std::size_t k = split[i * n + j];
    const Point3 centre = centre_of({o, ring[i], ring[k], ring[j]});
    std::array<std::ptrdiff_t, 2> behind{self(self, i, k), self(self, k, j)};
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t a = side == 0 ? i : k, b = side == 0 ? k : j;
      const Point3 other = behind[side] < 0 ? piece_of(star_[a]).centre
                                            : caps[static_cast<std::size_t>(behind[side])].centre;
      if (behind[side] < 0) over[a] = caps.size();
      worst.add_face({o, ring[a], ring[b]}, other, centre);
    }
    caps.push_back({{i, k, j}, centre});
    return static_cast<std::ptrdiff_t>(caps.size()) - 1;
  };
  visit(visit, 0, n - 1);
  worst.add_face({o, ring[n - 1], ring[0]}, piece_of(star_[n - 1]).centre, caps.back().centre);
  if (!(worst.share() > std::min(kGoodEndFaces, least_share))) return false;
  over[n - 1] = caps.size() - 1;
  const CellIndex first(first_cell_ + static_cast<std::int64_t>(upper_.cells.size()));
  for (std::size_t i = 0; i < n; ++i) cover(star_[i].piece, first + over[i]);
  for (const Spoke& spoke : star_)
    for (const VertexIndex u : {spoke.vertex, spoke.next}) std::erase(around_[u], spoke.piece);
  for (std::size_t i = 0; i < caps.size(); ++i) {
    const auto& r = caps[i].ring;
    const Front f = star_[i].piece;  // there are two more of them
    Piece& piece = pieces_[static_cast<std::size_t>(f)];
    for (std::size_t c = 0; c < 3; ++c) {
      piece.corners[c] = star_[r[c]].vertex;
      around_[piece.corners[c]].push_back(f);
    }
    const auto node = [&](std::size_t c) { return node_[piece.corners[c]]; };
    piece.cell = add_cell({node_[v], node(0), node(1), node(2)});
    piece.centre = caps[i].centre;
  }
  around_[v].clear();
  return true;
}

UpperMesh Grower::grow() {
  using Entry = std::pair<double, VertexIndex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto push = [&](VertexIndex v) {
    if (z_[v] < top_ && !around_[v].empty()) {
      find_star(v);
      queue.emplace(key(v), v);
    }
  };
  for (const VertexIndex v : mesh_.ground.vertices.indices()) push(v);
  while (!queue.empty()) {
    const auto [then, v] = queue.top();
    queue.pop();
    if (around_[v].empty() || !(z_[v] < top_)) continue;
    find_star(v);
    if (const double now = key(v); now > then) {
      queue.emplace(now, v);
      continue;
    }
    if (wants_to_end(v) && end(v, kGoodEnd, kLeastAngle)) continue;
    const auto [quality, to] = best_rise(v);
    if (quality < kGoodRise && may_end(v) && end(v, quality, kLeastAngleOfNeed)) continue;
    if (quality < 1 && worst_of_rise(v, to).is_below_floor()) {
      poor_.push_back(v);
      for (const Spoke& spoke : star_) poor_.push_back(spoke.vertex);
      if (star_.back().next != star_[0].vertex) poor_.push_back(star_.back().next);
    }
    rise(v, to);
    push(v);
  }
  return std::move(upper_);
}

}  // namespace

UpperMesh grow_upper(const ColumnMesh& mesh, double top) {
  std::vector<double> shares(mesh.vertex_count(), 1.0);
  UpperMesh best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int round = 0; round < kMostRounds && fewest > 0; ++round) {
    Grower grower(mesh, top, shares);
    UpperMesh upper = grower.grow();
    std::vector<VertexIndex> poor = grower.poor();
    if (poor.size() < fewest) {
      fewest = poor.size();
      best = std::move(upper);
    }
    sort_once(poor);
    for (const VertexIndex v : poor) shares[v] *= kShorter;
  }
  return best;
}

}  // namespace tetropolis
