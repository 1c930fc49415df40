#include "improve_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "tetropolis/volume/quality/cell_quality.h"

#include "core/disjoint_sets.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "tet_cosines.h"
#include "volume/column/levels.h"

namespace tetropolis {

namespace {

constexpr std::size_t kTrianglesPerChunk = 4096;
constexpr double kForever = kInfinity;

/// A change has to lower the cost by this share, so that rounding never makes changes go round.
constexpr double kWorthwhile = 1e-3;

/// Changes made to one column in one sweep, and cells looked at for that, at most.
constexpr int kChangesPerSweep = 8;
constexpr std::int64_t kMostCellsPerColumn = 50'000;

/// Connected stacks that one sweep works on, at most: those with the worst cells.
constexpr std::size_t kMostStacks = 2000;

// These, the windows and the pairs below were found by trial: by how many cities of the survey
// (scripts/survey 2000) are below the floor of quality.

/// Share of the least angle wanted below which a triangle's corner makes its stack hopeless.
constexpr double kHopeless = 2.0 / 3;

/// Columns between two looks at whether to stop.
constexpr std::size_t kColumnsPerBatch = 64;

/// Nodes below and above one of a bad cell that a trial leaves where they are: nodes between them
/// move.
constexpr std::array<std::array<std::int32_t, 2>, 6> kWindows{
    {{1, 1}, {0, 1}, {1, 2}, {2, 1}, {0, 3}, {1, 6}}};

/// Where two nodes are tried between two others, as shares of the distance.
constexpr std::array<std::array<double, 2>, 5> kPairs{
    {{1.0 / 3, 2.0 / 3}, {0.25, 0.5}, {0.5, 0.75}, {0.15, 0.5}, {0.5, 0.85}}};

/// What a cell outside of the floor costs beyond what others do: more than any face or cell within
/// it, and little enough that a change for the better beside it still counts (kWorthwhile).
constexpr double kBelowFloor = 100;

/// What a cell costs; nothing if its angles are within the bounds.
class Cost {
 public:
  explicit Cost(const ImproveOptions& options)
      : least_(1 - std::cos(to_radians(options.least_deg))),
        greatest_(1 + std::cos(to_radians(options.greatest_deg))),
        straight_(options.straight_deg < 90 ? std::cos(to_radians(options.straight_deg)) : 0) {}

  double of(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3) const {
    const TetCosines shape = tet_cosines(p0, p1, p2, p3);
    const bool below = shape.greatest > most_cosine_ || shape.least < least_cosine_;
    return excess(least_, 1 - shape.greatest) + excess(greatest_, 1 + shape.least) +
           (below ? kBelowFloor : 0);
  }
  bool has_faces() const { return straight_ > 0; }
  /// Of a face between cells with these centres.
  double of_face(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) const {
    const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
    const Point3 d = minus(c1, c0);
    return excess(straight_, std::abs(dot(n, d)) / std::sqrt(dot(n, n) * dot(d, d)));
  }

 private:
  static double excess(double wanted, double got) {
    if (got >= wanted) return 0;
    const double ratio = wanted / std::max(got, 1e-12);
    return ratio * ratio - 1;
  }

  double least_;
  double greatest_;
  double straight_;
  double most_cosine_ = std::cos(to_radians(kQualityFloor.least));
  double least_cosine_ = std::cos(to_radians(kQualityFloor.greatest));
};

/// A column on trial.
struct Column {
  std::vector<double> z;
  std::vector<std::int32_t> floors;
  std::vector<double> levels;  ///< Empty where the mesh has none.
};

struct ColumnView {
  std::span<const double> z;
  std::span<const std::int32_t> floors;  ///< Positions, as in ColumnMesh.
  std::span<const double> level;         ///< What fronts go by.

  ColumnView(std::span<const double> nodes, std::span<const std::int32_t> at,
             std::span<const double> climbing)
      : z(nodes), floors(at), level(climbing) {}
  ColumnView(const Column& column)  // NOLINT: as a string_view
      : z(column.z),
        floors(column.floors),
        level(column.levels.empty() ? std::span<const double>(column.z) : column.levels) {}
};

class Improver {
 public:
  Improver(const ColumnMesh& mesh, const ImproveOptions& options)
      : mesh_(&mesh),
        cost_(options),
        cells_per_sweep_(options.most_cells / std::max(options.sweeps, 1)),
        fixed_(options.fixed),
        most_gap_(options.most_gap),
        least_tangent_(std::tan(to_radians(kHopeless * options.least_deg))),
        slot_(mesh.vertex_count(), -1) {}

  /// Vertices of the triangles with the worst bad cells, ascending; of those near these triangles.
  std::vector<VertexIndex> bad_vertices(std::span<const std::uint8_t> near) const;
  std::vector<std::int32_t> colours_of(const std::vector<VertexIndex>& vertices) const;
  /// One pass over these columns; returns those that changed, ascending.
  std::vector<VertexIndex> sweep(const std::vector<VertexIndex>& vertices,
                                 const Progress& progress);
  /// The same among the triangles around these vertices.
  std::vector<VertexIndex> bad_around(const std::vector<VertexIndex>& vertices) const;
  /// Gives the mesh the nodes of all changed columns.
  void store(ColumnMesh& mesh) const;
  Improvement done() const;

 private:
  const std::array<VertexIndex, 3>& corners(TriangleIndex t) const {
    return mesh_->ground.triangles[t];
  }
  ColumnView column(VertexIndex v) const;
  void set_levels(VertexIndex v, Column& column) const;
  bool passes_roofs(VertexIndex v, const Column& column) const;
  std::vector<TriangleIndex> around(VertexIndex v) const;
  /// Position of triangle t's floor in `own`, a column over its corner v.
  std::int32_t floor(TriangleIndex t, VertexIndex v, ColumnView own) const {
    return own.floors[mesh_->place(mesh_->ground.region[t], v)];
  }

  /// Goes through the cells over t that have one of v's nodes first .. last, as if v's column were
  /// `own`. Calls visit(cost, node, rises) with the node of v's column that the cell stands on, and
  /// whether the cell has the one above it as well. Returns false at once if visit does.
  template <typename Visit>
  bool visit_cells(TriangleIndex t, VertexIndex v, ColumnView own, std::int32_t first,
                   std::int32_t last, const Visit& visit) const;
  /// Sum over those cells of all triangles; any number beyond `limit` if it is beyond.
  double cost(std::span<const TriangleIndex> triangles, VertexIndex v, ColumnView own,
              std::int32_t first, std::int32_t last, double limit, std::int64_t& left) const;
  bool is_hopeless(TriangleIndex t) const;
  double worst_cost(TriangleIndex t) const;
  template <typename TriangleAt>
  std::vector<VertexIndex> worst_of(std::size_t count, const TriangleAt& triangle_at) const;

  /// These look at about `left` cells at most, and lower it by as many as they do.
  Column improved(VertexIndex v, std::int64_t& left) const;
  bool improve_once(VertexIndex v, std::span<const TriangleIndex> triangles, Column& column,
                    std::int64_t& left) const;
  bool improve_between(VertexIndex v, std::span<const TriangleIndex> triangles, std::int32_t low,
                       std::int32_t high, Column& column, std::int64_t& left) const;

  const ColumnMesh* mesh_;
  Cost cost_;
  std::int64_t cells_per_sweep_;
  std::span<const std::uint8_t> fixed_;
  double most_gap_;
  double least_tangent_;            ///< Of the angle below which a corner is hopeless.
  std::vector<std::int32_t> slot_;  ///< Per vertex: its place in changed_, or -1.
  std::vector<Column> changed_;
  std::int64_t cells_ = 0;  ///< Looked at so far.
};

ColumnView Improver::column(VertexIndex v) const {
  if (slot_[v] >= 0) return changed_[static_cast<std::size_t>(slot_[v])];
  const double* const z = mesh_->z.data();
  const double* const level = mesh_->climbing().data();
  const NodeIndex first = mesh_->first[v], end = mesh_->first[v + 1];
  return {{z + first, z + end}, mesh_->floors_at(v), {level + first, level + end}};
}

void Improver::set_levels(VertexIndex v, Column& column) const {
  if (mesh_->levels.empty()) return;
  column.levels.resize(column.z.size());
  write_levels(column.z, column.floors, mesh_->floor_levels_at(v), column.levels.data());
}

/// Whether fronts pass through the edges of roofs beside `own` as a column over v.
bool Improver::passes_roofs(VertexIndex v, const Column& own) const {
  return mesh_->levels.empty() ||
         passes_around(*mesh_, {v, own.levels, own.floors}, [&](VertexIndex u) {
           const ColumnView other = column(u);
           return LevelledColumn{u, other.level, other.floors};
         });
}

std::vector<TriangleIndex> Improver::around(VertexIndex v) const {
  return triangles_around(mesh_->edges, {&v, 1});
}

template <typename Visit>
bool Improver::visit_cells(TriangleIndex t, VertexIndex v, ColumnView own, std::int32_t first,
                           std::int32_t last, const Visit& visit) const {
  const std::array<VertexIndex, 3>& vertices = corners(t);
  std::array<const double*, 3> z{}, level{};
  std::array<NodeIndex, 3> at{}, top{};
  std::size_t mine = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (vertices[i] == v) mine = i;
    const ColumnView here = vertices[i] == v ? own : column(vertices[i]);
    z[i] = here.z.data();
    level[i] = here.level.data();
    at[i] = NodeIndex(floor(t, vertices[i], here));
    top[i] = NodeIndex(here.z.size()) - 1;
  }
  if (first > at[mine]) {
    // The front when v's column is about to reach node `first`.
    at[mine] = NodeIndex(first - 1);
    const double key = climbing_key(level[mine], at[mine]);
    for (std::size_t i = 0; i < 3; ++i) {
      if (i == mine) continue;
      NodeIndex above = top[i];
      while (at[i] < above) {
        const NodeIndex middle = at[i] + (above - at[i]) / 2;
        if (climbs_first(climbing_key(level[i], middle), vertices[i], key, v))
          at[i] = middle + 1;
        else
          above = middle;
      }
    }
  }
  Climb<3> front(level, vertices, at, top);
  std::array<Point3, 3> p;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point2 place = mesh_->ground.vertices[vertices[i]];
    p[i] = {place.x, place.y, *(z[i] + at[i])};
  }
  Point3 below{};
  bool is_first = true;
  for (std::size_t next; (next = front.next()) < 3; front.advance(next)) {
    const Point3 apex{p[next][0], p[next][1], *(z[next] + (front.at(next) + 1))};
    const auto node = static_cast<std::int32_t>(front.at(mine).value());
    double cost = cost_.of(p[0], p[1], p[2], apex);
    if (cost_.has_faces()) {
      const Point3 centre = centre_of({p[0], p[1], p[2], apex});
      if (!std::exchange(is_first, false)) cost += cost_.of_face(p, below, centre);
      below = centre;
    }
    if (!visit(cost, node, next == mine)) return false;
    if (next == mine && node >= last) return true;
    p[next] = apex;
  }
  return true;
}

double Improver::cost(std::span<const TriangleIndex> triangles, VertexIndex v, ColumnView own,
                      std::int32_t first, std::int32_t last, double limit,
                      std::int64_t& left) const {
  double sum = 0;
  for (const TriangleIndex t : triangles) {
    if (last < floor(t, v, own)) continue;  // there are no cells below
    const bool within = visit_cells(t, v, own, first, last, [&](double cell, std::int32_t, bool) {
      sum += cell;
      --left;
      return sum < limit;
    });
    if (!within) break;
  }
  return sum;
}

/// Each corner of the triangle is a dihedral angle of the cells that rise there, whatever the
/// nodes; and so is about that between the side across from it and a node so far above it.
bool Improver::is_hopeless(TriangleIndex t) const {
  const std::array<VertexIndex, 3>& v = corners(t);
  for (std::size_t i = 0; i < 3; ++i) {
    const Point2 p = mesh_->ground.vertices[v[i]];
    const Point2 q = mesh_->ground.vertices[v[(i + 1) % 3]];
    const Point2 r = mesh_->ground.vertices[v[(i + 2) % 3]];
    const double along = (q.x - p.x) * (r.x - p.x) + (q.y - p.y) * (r.y - p.y);
    const double across = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    if (across < least_tangent_ * along) return true;
    if (most_gap_ < least_tangent_ * across / std::hypot(r.x - q.x, r.y - q.y)) return true;
  }
  return false;
}

double Improver::worst_cost(TriangleIndex t) const {
  if (is_hopeless(t)) return 0;
  const VertexIndex v = corners(t)[0];
  const ColumnView own = column(v);
  double worst = 0;
  visit_cells(t, v, own, 0, static_cast<std::int32_t>(own.z.size()) - 1,
              [&](double cell, std::int32_t, bool) {
                worst = std::max(worst, cell);
                return true;
              });
  return worst;
}

template <typename TriangleAt>
std::vector<VertexIndex> Improver::worst_of(std::size_t count,
                                            const TriangleAt& triangle_at) const {
  std::vector<double> cost(count, 0.0);
  parallel_chunks(count, kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) cost[i] = worst_cost(triangle_at(i));
  });
  std::vector<std::size_t> bad;
  for (std::size_t i = 0; i < count; ++i)
    if (cost[i] > 0) bad.push_back(i);
  if (bad.size() > kMostStacks) {
    DisjointSets<VertexIndex> places(mesh_->vertex_count());
    for (const std::size_t i : bad)
      for (const VertexIndex v : corners(triangle_at(i)))
        places.join(corners(triangle_at(i))[0], v);
    std::vector<std::tuple<VertexIndex, double, std::size_t>> worst;  // first of each place
    for (const std::size_t i : bad)
      worst.emplace_back(places.root(corners(triangle_at(i))[0]), -cost[i], i);
    std::sort(worst.begin(), worst.end());
    bad.clear();
    VertexIndex place = kNoVertex;
    std::size_t rank = 0;
    for (const auto& [root, minus_cost, i] : worst) {
      rank = root == std::exchange(place, root) ? rank + 1 : 0;
      if (rank < kMostStacks) bad.push_back(i);
    }
  }
  std::vector<VertexIndex> vertices;
  for (const std::size_t i : bad)
    for (const VertexIndex v : corners(triangle_at(i)))
      if (fixed_.empty() || fixed_[v] == 0) vertices.push_back(v);
  sort_once(vertices);
  return vertices;
}

std::vector<VertexIndex> Improver::bad_vertices(std::span<const std::uint8_t> near) const {
  if (!near.empty()) {
    std::vector<VertexIndex> vertices;
    for (const TriangleIndex t : indices<TriangleIndex>(near.size()))
      if (near[t] != 0)
        for (const VertexIndex v : corners(t)) vertices.push_back(v);
    sort_once(vertices);
    return bad_around(vertices);
  }
  return worst_of(mesh_->triangle_count(), [](std::size_t i) { return TriangleIndex(i); });
}

std::vector<VertexIndex> Improver::bad_around(const std::vector<VertexIndex>& vertices) const {
  const std::vector<TriangleIndex> triangles = triangles_around(mesh_->edges, vertices);
  return worst_of(triangles.size(), [&](std::size_t i) { return triangles[i]; });
}

/// Tries other nodes between `low` and `high`, which stay; takes the best if it is better.
bool Improver::improve_between(VertexIndex v, std::span<const TriangleIndex> triangles,
                               std::int32_t low, std::int32_t high, Column& column,
                               std::int64_t& left) const {
  const double now = cost(triangles, v, column, low, high, kForever, left);
  if (!(now > 0)) return false;
  const auto before = static_cast<std::size_t>(low) + 1, after = static_cast<std::size_t>(high);
  const double z0 = column.z[before - 1], z1 = column.z[after];
  Column trial, best;
  double least = now * (1 - kWorthwhile);
  const auto attempt = [&](std::span<const double> between) {
    trial.z.assign(column.z.begin(), column.z.begin() + static_cast<std::ptrdiff_t>(before));
    const auto follows = [&](double z) {
      return z > trial.z.back() && z - trial.z.back() <= most_gap_;
    };
    for (const double z : between) {
      if (!follows(z)) return;
      trial.z.push_back(z);
    }
    if (!follows(z1)) return;
    trial.z.insert(trial.z.end(), column.z.begin() + static_cast<std::ptrdiff_t>(after),
                   column.z.end());
    const auto change =
        static_cast<std::int32_t>(trial.z.size()) - static_cast<std::int32_t>(column.z.size());
    trial.floors = column.floors;
    for (std::int32_t& floor : trial.floors) floor += floor >= high ? change : 0;
    set_levels(v, trial);
    const double cost_then = cost(triangles, v, trial, low, high + change, least, left);
    if (!(cost_then < least) || !passes_roofs(v, trial)) return;
    least = cost_then;
    std::swap(best, trial);
  };
  const auto at = [&](double share) { return z0 + (z1 - z0) * share; };
  attempt({});
  const std::int32_t inner = high - low - 1;
  for (int i = 1; i < 8; ++i) attempt(std::array{at(i / 8.0)});
  if (inner == 1)
    for (const double step : {-0.04, -0.015, 0.015, 0.04})
      attempt(std::array{column.z[before] + step * (z1 - z0)});
  if (inner > 0) {
    for (const auto& [a, b] : kPairs) attempt(std::array{at(a), at(b)});
    std::array<double, 8> even{};
    for (std::int32_t n = 3; n <= std::min(inner + 1, 8); ++n) {
      for (std::int32_t i = 0; i < n; ++i)
        even[static_cast<std::size_t>(i)] = at((i + 1.0) / (n + 1.0));
      attempt(std::span(even).first(static_cast<std::size_t>(n)));
    }
  }
  if (best.z.empty()) return false;
  column = std::move(best);
  return true;
}

bool Improver::improve_once(VertexIndex v, std::span<const TriangleIndex> triangles, Column& column,
                            std::int64_t& left) const {
  const auto last = static_cast<std::int32_t>(column.z.size()) - 1;
  std::vector<char> bad(column.z.size(), 0);
  for (const TriangleIndex t : triangles)
    visit_cells(t, v, column, 0, last, [&](double cell, std::int32_t node, bool rises) {
      if (cell > 0) {
        bad[static_cast<std::size_t>(node)] = 1;
        if (rises) bad[static_cast<std::size_t>(node) + 1] = 1;
      }
      --left;
      return true;
    });
  const auto fixed_between = [&](std::int32_t low, std::int32_t high) {
    const auto between = [&](std::int32_t floor) { return floor > low && floor < high; };
    return low < 0 || high > last ||
           std::any_of(column.floors.begin(), column.floors.end(), between);
  };
  for (std::int32_t node = 0; node <= last; ++node) {
    if (bad[static_cast<std::size_t>(node)] == 0) continue;
    for (const auto& [down, up] : kWindows) {
      const std::int32_t low = node - down, high = node + up;
      if (left <= 0) return false;
      if (!fixed_between(low, high) && improve_between(v, triangles, low, high, column, left))
        return true;
    }
  }
  return false;
}

Column Improver::improved(VertexIndex v, std::int64_t& left) const {
  const std::vector<TriangleIndex> triangles = around(v);
  const ColumnView now = column(v);
  Column better{{now.z.begin(), now.z.end()}, {now.floors.begin(), now.floors.end()}, {}};
  set_levels(v, better);
  bool changed = false;
  for (int i = 0; i < kChangesPerSweep && improve_once(v, triangles, better, left); ++i)
    changed = true;
  return changed ? better : Column{};
}

/// Numbers from 0, so that no two of the vertices in one triangle have the same. `vertices` ascend.
std::vector<std::int32_t> Improver::colours_of(const std::vector<VertexIndex>& vertices) const {
  std::vector<std::int32_t> colour(vertices.size(), -1);
  const auto place = [&](VertexIndex v) {
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), v);
    return found != vertices.end() && *found == v
               ? static_cast<std::ptrdiff_t>(found - vertices.begin())
               : std::ptrdiff_t{-1};
  };
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::vector<std::int32_t> taken;
    for (const TriangleIndex t : around(vertices[i]))
      for (const VertexIndex v : corners(t))
        if (const std::ptrdiff_t other = place(v); other >= 0)
          taken.push_back(colour[static_cast<std::size_t>(other)]);
    std::int32_t free = 0;
    while (std::find(taken.begin(), taken.end(), free) != taken.end()) ++free;
    colour[i] = free;
  }
  return colour;
}

std::vector<VertexIndex> Improver::sweep(const std::vector<VertexIndex>& vertices,
                                         const Progress& progress) {
  const std::vector<std::int32_t> colour = colours_of(vertices);
  const std::int32_t colours = 1 + *std::max_element(colour.begin(), colour.end());
  const std::int64_t share =
      std::min(kMostCellsPerColumn, cells_per_sweep_ / static_cast<std::int64_t>(vertices.size()));
  std::vector<VertexIndex> changed;
  for (std::int32_t c = 0; c < colours; ++c) {
    std::vector<VertexIndex> members;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (colour[i] == c) members.push_back(vertices[i]);
    std::vector<Column> columns(members.size());
    std::vector<std::int64_t> left(members.size(), share);
    for (std::size_t first = 0; first < members.size(); first += kColumnsPerBatch) {
      progress.update(0);
      const std::size_t count = std::min(kColumnsPerBatch, members.size() - first);
      parallel_chunks(count, 1, [&](std::size_t i, std::size_t) {
        columns[first + i] = improved(members[first + i], left[first + i]);
      });
    }
    for (std::size_t i = 0; i < members.size(); ++i) {
      cells_ += share - left[i];
      if (columns[i].z.empty()) continue;
      std::int32_t& slot = slot_[members[i]];
      if (slot < 0) {
        slot = static_cast<std::int32_t>(changed_.size());
        changed_.emplace_back();
      }
      changed_[static_cast<std::size_t>(slot)] = std::move(columns[i]);
      changed.push_back(members[i]);
    }
  }
  std::sort(changed.begin(), changed.end());
  return changed;
}

Improvement Improver::done() const {
  Improvement improvement{{}, cells_};
  for (const VertexIndex v : indices<VertexIndex>(slot_.size()))
    if (slot_[v] >= 0) improvement.columns.push_back(v);
  return improvement;
}

void Improver::store(ColumnMesh& mesh) const {
  if (changed_.empty()) return;
  std::vector<NodeIndex> first{NodeIndex(0)};
  first.reserve(mesh.first.size());
  std::vector<std::int32_t> floors;
  floors.reserve(mesh.floors.size());
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    const ColumnView own = column(v);
    first.push_back(first.back() + own.z.size());
    floors.insert(floors.end(), own.floors.begin(), own.floors.end());
  }
  std::vector<double> z;
  z.reserve(first.back());
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    const ColumnView own = column(v);
    z.insert(z.end(), own.z.begin(), own.z.end());
  }
  if (!mesh.levels.empty()) {
    std::vector<double> levels;
    levels.reserve(z.size());
    for (const VertexIndex v : mesh.ground.vertices.indices()) {
      const ColumnView own = column(v);
      levels.insert(levels.end(), own.level.begin(), own.level.end());
    }
    mesh.levels = std::move(levels);
  }
  mesh.first = std::move(first);
  mesh.z = std::move(z);
  mesh.floors = std::move(floors);
}

}  // namespace

Improvement improve_columns(ColumnMesh& mesh, const ImproveOptions& options,
                            const Progress& progress) {
  if (options.most_cells <= 0) return {};
  Improver improver(mesh, options);
  std::vector<VertexIndex> vertices = improver.bad_vertices(options.near);
  for (int i = 0; i < options.sweeps && !vertices.empty(); ++i)
    vertices = improver.bad_around(improver.sweep(vertices, progress));
  Improvement done = improver.done();
  if (options.before_change) options.before_change(done.columns);
  improver.store(mesh);
  return done;
}

}  // namespace tetropolis
