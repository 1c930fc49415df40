#include "front.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "climber.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "geometry/hash_of.h"
#include "geometry/vec3.h"
#include "volume/column/upper_faces.h"

namespace tetropolis {

namespace {

/// Columns that a tile is to be wide, about: many more than wait for those at a seam, and few
/// enough for a cache.
constexpr double kColumnsAcross = 80;

/// Of tiles, in sides: at first, then across the seams, and across the seams of those.
constexpr std::array<std::pair<double, double>, 4> kShifts{
    {{0.0, 0.0}, {0.5, 0.5}, {0.5, 0.0}, {0.0, 0.5}}};
/// After so many times of these, as good as none are left.
constexpr std::size_t kRounds = 3;

/// Orders those around v, of which each begins a triangle of the ground.
void order_around(VertexIndex v, const GroundMesh& ground, std::vector<Neighbour>& around) {
  const auto next = [&](const Neighbour& n) {
    const auto& c = ground.triangles[TriangleIndex(n.piece)];
    return c[0] == v ? c[2] : c[1] == v ? c[0] : c[1];
  };
  // At the rim the first is the one that no other leads to.
  for (std::size_t i = 0; i < around.size(); ++i) {
    const auto leads = [&](const Neighbour& n) { return next(n) == around[i].vertex; };
    if (std::none_of(around.begin(), around.end(), leads)) {
      std::swap(around[0], around[i]);
      break;
    }
  }
  for (std::size_t i = 1; i < around.size(); ++i)
    for (std::size_t j = i; j < around.size(); ++j)
      if (around[j].vertex == next(around[i - 1])) {
        std::swap(around[i], around[j]);
        break;
      }
  if (!around.empty() && next(around.back()) != around.front().vertex)
    around.push_back({next(around.back()), kNoPiece});
}

/// Puts the column on the lid.
void start_column(const ColumnMesh& mesh, VertexIndex v, Front& front) {
  FrontColumn& own = front.columns[v];
  own = {};
  own.at = position(mesh, v, mesh.top(v));
  own.lid = own.at[2];
  std::vector<Neighbour>& around = front.around[v];
  around.clear();
  const auto edges_from = static_cast<std::size_t>(mesh.edges.starts[v + 1] - mesh.edges.starts[v]);
  around.reserve(edges_from + mesh.edges.ends[v].size() + 1);
  double longest2 = 0;
  const auto add = [&](EdgeIndex e) {
    const auto [a, b] = mesh.edges.vertices[e];
    const Point2 p = mesh.ground.vertices[a], q = mesh.ground.vertices[b];
    longest2 = std::max(longest2, (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y));
    for (const TriangleIndex t : mesh.edges.triangles[e]) {
      if (t == kNoTriangle) {
        own.stays = true;
        continue;
      }
      // The triangle to the left of the edge.
      const auto& c = mesh.ground.triangles[t];
      const VertexIndex next = c[0] == v ? c[1] : c[1] == v ? c[2] : c[0];
      if (next == (a == v ? b : a)) around.push_back({next, t.value()});
    }
  };
  for (const EdgeIndex e : mesh.edges.starting_at(v)) add(e);
  for (const EdgeIndex e : mesh.edges.ends[v]) add(e);
  own.edge = std::sqrt(longest2);
  order_around(v, mesh.ground, around);
}

void start_triangle(const ColumnMesh& mesh, TriangleIndex t, Front& front) {
  std::uint64_t place = 0;  // its number would depend on far places
  for (const VertexIndex v : mesh.ground.triangles[t]) place += hash_of(mesh.ground.vertices[v]);
  front.triangles[t] = {static_cast<std::int32_t>(place >> 33U), VertexIndex(0), -kInfinity,
                        centre_of(uppermost_cell(mesh, t)), true};
}

/// Square tiles over the ground, from its lower left corner or shifted by half of one.
class Tiles {
 public:
  /// `along`: the longer side.
  Tiles(const GroundMesh& ground, std::size_t along) {
    const Bounds2 box = bounds(ground.vertices);
    corner_ = {box.xmin, box.ymin};
    side_ = std::max(box.width(), box.height()) / static_cast<double>(along);
    columns_ = static_cast<std::size_t>(box.width() / side_) + 2;
    rows_ = static_cast<std::size_t>(box.height() / side_) + 2;
  }
  std::size_t size() const { return columns_ * rows_; }
  std::size_t at(const Point3& p, double shift_x, double shift_y) const {
    const auto x = static_cast<std::size_t>((p[0] - corner_.x) / side_ + shift_x);
    const auto y = static_cast<std::size_t>((p[1] - corner_.y) / side_ + shift_y);
    return y * columns_ + x;
  }

 private:
  Point2 corner_;
  double side_ = 0;
  std::size_t columns_ = 0, rows_ = 0;
};

}  // namespace

std::size_t useful_tiles(const ColumnMesh& mesh) {
  const double across = std::sqrt(static_cast<double>(mesh.vertex_count())) / kColumnsAcross;
  return static_cast<std::size_t>(std::max(across, 1.0));
}

FrontRecord::FrontRecord(const FrontPhases& phases, std::span<const std::uint8_t> is_kept)
    : first_(is_kept.size() + 1, 0) {
  const auto for_all = [&](const auto& visit) {
    for (const std::vector<FrontSteps>& tiles : phases)
      // Those of a phase have no column in common.
      parallel_in_order(tiles.size(), [&](std::size_t i) {
        const double* order = tiles[i].orders.data();
        for_each_step(tiles[i], [&](const FrontStep& step, std::span<const VertexIndex> others) {
          const double own = *order++;
          if (is_kept[step.vertex] != 0) visit(step, others, own);
        });
      });
  };
  for_all([&](const FrontStep& step, auto, double) { ++first_[step.vertex + 1]; });
  std::inclusive_scan(first_.begin(), first_.end(), first_.begin());
  steps_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_all([&](const FrontStep& step, std::span<const VertexIndex> others, double order) {
    steps_[next[step.vertex]++] = {&step, others.data(), order};
  });
}

FrontClimb::FrontClimb(const ColumnMesh& mesh, double top, std::size_t tiles,
                       std::function<bool()> cancelled)
    : mesh_(mesh),
      tiles_(tiles),
      front_(std::make_unique<Front>()),
      cancelled_(std::move(cancelled)) {
  front_->top = top;
  front_->columns.resize(mesh.vertex_count());
  front_->turns.resize(mesh.vertex_count());
  front_->triangles.resize(mesh.triangle_count());
  front_->around.resize(mesh.vertex_count());
}

FrontClimb::~FrontClimb() = default;

void FrontClimb::poll() {
  if (!cancelled_) return;
  const std::lock_guard lock(polling_);
  if (cancelled_()) throw Cancelled();
}

void FrontClimb::start(std::span<const VertexIndex> columns, std::span<const double> shares) {
  parallel_chunks(columns.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : columns.subspan(begin, end - begin)) start_column(mesh_, v, *front_);
  });
  parallel_chunks(columns.size(), 4096, [&](std::size_t begin, std::size_t end) {
    FrontSteps none;
    Climber climber(*front_, shares, none);
    for (const VertexIndex v : columns.subspan(begin, end - begin)) {
      front_->turns[v] = {};
      climber.set_due(v);
    }
  });
}

FrontPhases FrontClimb::to_top(std::span<const double> shares) {
  std::vector<VertexIndex> all(mesh_.vertex_count());
  std::iota(all.begin(), all.end(), VertexIndex(0));
  parallel_chunks(mesh_.triangle_count(), 4096, [&](std::size_t begin, std::size_t end) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
      start_triangle(mesh_, t, *front_);
  });
  start(all, shares);
  FrontPhases phases;
  // Returns whether some were left.
  const auto climb = [&](std::size_t count, const auto& tile_at) {
    std::vector<std::vector<VertexIndex>> columns(count);
    bool is_any_left = false;
    for (const VertexIndex v : all) {
      Turn& turn = front_->turns[v];
      const std::size_t tile = tile_at(front_->columns[v].at);
      turn.tile = static_cast<std::int32_t>(tile);
      if (!(turn.due < kInfinity)) continue;
      columns[tile].push_back(v);
      is_any_left = true;
    }
    if (!is_any_left) return false;
    std::vector<FrontSteps>& steps = phases.emplace_back(count);
    ++phase_;
    parallel_in_order(count, [&](std::size_t i) {
      poll();
      Climber climber(*front_, shares, steps[i]);
      for (const VertexIndex v : columns[i]) climber.climb(v, phase_);
      steps[i].shrink();
    });
    return true;
  };
  const Tiles grid(mesh_.ground, tiles_);
  bool is_any_left = tiles_ > 1;
  for (std::size_t i = 0; is_any_left && i < kRounds * kShifts.size(); ++i) {
    const auto [x, y] = kShifts[i % kShifts.size()];
    is_any_left =
        climb(grid.size(), [&, x = x, y = y](const Point3& p) { return grid.at(p, x, y); });
  }
  climb(1, [](const Point3&) { return std::size_t{0}; });
  for (std::vector<Neighbour>& around : front_->around) around.clear();
  return phases;
}

std::optional<StepsWithin> FrontClimb::within(std::span<const VertexIndex> columns,
                                              std::span<const VertexIndex> others,
                                              const FrontRecord& record,
                                              std::span<const double> shares) {
  poll();
  for (const VertexIndex v : others) {
    start_column(mesh_, v, *front_);
    front_->around[v].clear();
  }
  for (const TriangleIndex t : triangles_around(mesh_.edges, columns))
    start_triangle(mesh_, t, *front_);
  start(columns, shares);
  StepsWithin result;
  const bool is_sound =
      Climber(*front_, shares, result.done, &result.risen).climb(columns, others, record);
  for (const VertexIndex v : columns) front_->around[v].clear();
  if (!is_sound) return std::nullopt;
  result.done.shrink();
  result.risen.shrink_to_fit();
  return result;
}

}  // namespace tetropolis
