#include "laplace_multigrid.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "laplace_coarsen.h"
#include "laplace_galerkin.h"

namespace tetropolis {

namespace {

// A sweep converges when the damping is below two over the greatest eigenvalue of T^-1 A. That is
// below 3 on the finest level whatever the mesh, as a tet touches three columns and so x.Ax <= 3
// x.Tx element by element; but with the angles of a quality mesh it is about 1.8.
constexpr float kDamping = 0.85F;
constexpr float kSafeDamping = 0.6F;
constexpr std::size_t kFewestColumns = 32;
constexpr int kCoarsestSweeps = 4;

/// Chunks of a size that depends on the level alone: about a hundred, or of 256 columns.
std::size_t grain(std::size_t columns) { return std::clamp<std::size_t>(columns / 64, 8, 256); }

}  // namespace

Multigrid::Multigrid(const LevelMatrix& matrix, const LevelGraph& graph, EdgeWeights weights,
                     double height, double area)
    : matrix_(matrix), graph_(graph), damping_(kDamping) {
  constexpr std::size_t kMostLevels = 32;
  const LevelMatrix* finer = &matrix;
  LevelGraph finer_graph = graph;
  levels_.reserve(kMostLevels);  // so that `finer` and `finer_graph`, which point into it, last
  while (finer_graph.columns > kFewestColumns && levels_.size() < kMostLevels &&
         area / static_cast<double>(finer_graph.columns) < height * height) {
    Interpolation p = coarsen(finer_graph, weights);
    const std::size_t columns = p.fine.size();
    if (columns * 4 > finer_graph.columns * 3) break;  // too little coarser to be worth it
    CoarseLevel coarse = coarse_level(*finer, finer_graph, p);
    const std::size_t size = columns * matrix.stride;
    weights = std::move(coarse.weights);
    levels_.push_back({std::move(coarse.graph), std::move(coarse.matrix), std::move(p),
                       PaddedFloats(size), PaddedFloats(size), PaddedFloats(size)});
    finer = &levels_.back().matrix;
    finer_graph = levels_.back().graph.view();
  }
}

bool Multigrid::make_safe() {
  const bool changed = damping_ != kSafeDamping;
  damping_ = kSafeDamping;
  return changed;
}

double Multigrid::apply_to_smoothed(const float* b, float* x, float* y) {
  return cycle(0, b, x, y);
}

double Multigrid::cycle(std::size_t level, const float* b, float* x, float* y) {
  const LevelMatrix& a = level == 0 ? matrix_ : levels_[level - 1].matrix;
  const LevelGraph graph = level == 0 ? graph_ : levels_[level - 1].graph.view();
  const std::size_t chunk = grain(graph.columns);
  const auto columns = [&](const auto& kernel) {
    parallel_chunks(graph.columns, chunk, [&](std::size_t begin, std::size_t end) {
      kernel(ColumnRange{begin, end});
    });
  };
  const auto last_sweep = [&] {
    return parallel_reduce_ordered(
        graph.columns, chunk, 0.0,
        [&](std::size_t begin, std::size_t end) {
          return sweep(a, graph, damping_, b, x, y, {begin, end});
        },
        [](double p, double q) { return p + q; });
  };
  if (level == levels_.size()) {
    // An even number of further sweeps ends in x, and one more in y.
    for (int i = 0; i + 2 < kCoarsestSweeps; i += 2) {
      columns([&](ColumnRange range) { sweep(a, graph, damping_, b, x, y, range); });
      columns([&](ColumnRange range) { sweep(a, graph, damping_, b, y, x, range); });
    }
    return last_sweep();
  }
  Level& coarse = levels_[level];
  const std::size_t coarse_columns = coarse.graph.view().columns;
  columns([&](ColumnRange range) { residual(a, graph, b, x, y, range); });
  parallel_chunks(coarse_columns, grain(coarse_columns), [&](std::size_t begin, std::size_t end) {
    restrict_columns(coarse.to_finer, a.stride, y, coarse.b.data(), {begin, end});
    solve_columns(coarse.matrix, damping_, coarse.b.data(), coarse.x.data(), {begin, end});
  });
  cycle(level + 1, coarse.b.data(), coarse.x.data(), coarse.y.data());
  columns([&](ColumnRange range) {
    add_interpolated(coarse.to_finer, a.stride, coarse.y.data(), x, range);
  });
  return last_sweep();
}

}  // namespace tetropolis
