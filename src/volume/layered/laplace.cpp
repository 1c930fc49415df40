#include "laplace.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "laplace_bands.h"
#include "laplace_galerkin.h"
#include "laplace_multigrid.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerSum = 256;

/// A solve that takes this many iterations has a bad smoother.
constexpr int kPatience = 40;

/// Clears the row of node (v, k) in the bands of v's column.
void clear_own(LevelMatrix& matrix, VertexIndex v, std::size_t k) {
  matrix.diagonal[v * matrix.stride + k] = 0;
  matrix.vertical[v * matrix.stride + k] = 0;
  if (k > 0) matrix.vertical[v * matrix.stride + k - 1] = 0;
}

/// Takes out the couplings of given nodes between bottom and top; makes the residual zero at all
/// given nodes. Returns the number of nodes left unknown.
std::int64_t impose_given(const LayeredMesh& mesh, bool fixed_top, LevelMatrix& matrix,
                          PaddedFloats& r) {
  const std::size_t stride = matrix.stride;
  const auto layers = static_cast<std::size_t>(mesh.layers);
  // Given layers of a column other than 0 and a fixed top.
  const auto for_inner = [&](VertexIndex v, const auto& body) {
    for (std::int32_t k = 1; k <= mesh.first_node[v]; ++k) body(static_cast<std::size_t>(k));
    if (mesh.roof_layer[v] > mesh.first_node[v]) body(static_cast<std::size_t>(mesh.roof_layer[v]));
  };
  const auto impose = [&](std::size_t begin, std::size_t end) {
    std::int64_t unknowns = 0;
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      std::size_t given = fixed_top ? 2 : 1;
      r[v * stride] = 0;
      if (fixed_top) r[v * stride + layers] = 0;
      for_inner(v, [&](std::size_t k) {
        r[v * stride + k] = 0;
        if (!fixed_top || k < layers) ++given;
        clear_own(matrix, v, k);
      });
      unknowns += static_cast<std::int64_t>(layers + 1 - given);
      for (const EdgeIndex e : mesh.edges.starting_at(v)) {
        const VertexIndex b = mesh.edges.vertices[e][1];
        float* level = matrix.edge.data() + 2 * e * stride;
        float* rising = level + stride;
        for_inner(v, [&](std::size_t k) { level[k] = rising[k] = 0; });
        for_inner(b, [&](std::size_t k) { level[k] = rising[k - 1] = 0; });
      }
    }
    return unknowns;
  };
  return parallel_reduce_ordered(mesh.vertex_count(), kColumnsPerSum, std::int64_t{0}, impose,
                                 [](std::int64_t a, std::int64_t b) { return a + b; });
}

double mean_height(const LayeredMesh& mesh) {
  double sum = 0;
  for (const VertexIndex v : mesh.ground.vertices.indices())
    sum += mesh.column(v)[mesh.layers] - mesh.column(v)[0];
  return sum / static_cast<double>(mesh.vertex_count());
}

double plan_area(const GroundMesh& ground) {
  double sum = 0;
  for (const auto& t : ground.triangles) {
    const Point2 a = ground.vertices[t[0]];
    const Point2 b = ground.vertices[t[1]];
    const Point2 c = ground.vertices[t[2]];
    sum += std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;
  }
  return sum;
}

/// Conjugate gradients, in single precision, for the equations of a layered mesh, preconditioned by
/// a multigrid cycle. Vectors have one entry per node, columns padded to the matrix's stride.
class ConjugateGradients {
 public:
  /// `matrix` and `r`, the residual of the first guess, with given nodes imposed.
  ConjugateGradients(const LayeredMesh& mesh, const LevelMatrix& matrix, PaddedFloats r,
                     EdgeWeights weights)
      : mesh_(mesh),
        matrix_(matrix),
        graph_(mesh.edges),
        preconditioner_(matrix_, graph_, std::move(weights), mean_height(mesh),
                        plan_area(mesh.ground)),
        r_(std::move(r)),
        p_(r_.size()),
        q_(r_.size()),
        z_(r_.size()) {}

  /// Adds to u, which has one entry per node without padding.
  void solve(const LaplaceOptions& options, const Progress& progress, std::vector<float>& u,
             SolverReport& report);

 private:
  template <typename Kernel>
  void over_columns(const Kernel& kernel) const {
    parallel_chunks(mesh_.vertex_count(), kColumnsPerSum, [&](std::size_t begin, std::size_t end) {
      kernel(ColumnRange{begin, end});
    });
  }

  /// The first half sweep of the preconditioner needs nothing but the column's own residual, so it
  /// is made where that is known.
  void smooth(ColumnRange range) {
    solve_columns(matrix_, preconditioner_.damping(), r_.data(), z_.data(), range);
  }

  /// q = M^-1 r, where z is r smoothed. Returns r q: a sum of squares, unless the smoother does not
  /// converge on this mesh.
  double precondition() {
    return preconditioner_.apply_to_smoothed(r_.data(), z_.data(), q_.data());
  }

  double smooth_and_precondition() {
    over_columns([&](ColumnRange range) { smooth(range); });
    return precondition();
  }

  /// p = q + beta p
  void new_direction(float beta) {
    over_columns([&](ColumnRange range) {
      for (std::size_t i = range.begin * matrix_.stride; i < range.end * matrix_.stride; ++i)
        p_[i] = q_[i] + beta * p_[i];
    });
  }

  /// q = A p. Returns p q.
  double multiply_direction() {
    return parallel_reduce_ordered(
        mesh_.vertex_count(), kColumnsPerSum, 0.0,
        [&](std::size_t begin, std::size_t end) {
          return multiply(matrix_, graph_, p_.data(), q_.data(), {begin, end});
        },
        [](double a, double b) { return a + b; });
  }

  /// u += alpha p, r -= alpha q, and r smoothed.
  void step(float alpha, std::vector<float>& u) {
    const std::size_t n = mesh_.stride(), stride = matrix_.stride;
    over_columns([&](ColumnRange range) {
      for (std::size_t v = range.begin; v < range.end; ++v)
        for (std::size_t k = 0; k < n; ++k) u[v * n + k] += alpha * p_[v * stride + k];
      for (std::size_t i = range.begin * stride; i < range.end * stride; ++i)
        r_[i] -= alpha * q_[i];
      smooth(range);
    });
  }

  /// With a smoother that converges on any mesh. False if it is in use already.
  bool restart_safely(double& rz) {
    if (!preconditioner_.make_safe()) return false;
    rz = smooth_and_precondition();
    return rz > 0;
  }

  const LayeredMesh& mesh_;
  const LevelMatrix& matrix_;
  LevelGraph graph_;
  Multigrid preconditioner_;
  PaddedFloats r_, p_, q_, z_;
};

void ConjugateGradients::solve(const LaplaceOptions& options, const Progress& progress,
                               std::vector<float>& u, SolverReport& report) {
  double rz = smooth_and_precondition();
  if (rz < 0) restart_safely(rz);
  const double first_rz = rz, target = options.tolerance * options.tolerance * rz;
  report.converged = rz == 0;
  float beta = 0;
  while (rz > 0 && !report.converged && report.iterations < options.max_iterations) {
    progress.update(
        report.iterations == 0
            ? 0.0
            : std::clamp(std::log(rz / first_rz) / std::log(target / first_rz), 0.0, 1.0));
    new_direction(beta);
    const double pq = multiply_direction();
    if (!(pq > 0)) break;  // rounding level reached: no direction reduces the energy any more
    step(static_cast<float>(rz / pq), u);
    ++report.iterations;
    const double next = precondition();
    beta = static_cast<float>(next / rz);
    rz = next;
    if (rz < 0 || report.iterations == kPatience) {
      if (!restart_safely(rz) && rz < 0) break;
      beta = 0;
    }
    report.converged = rz <= target;
  }
  report.relative_residual = first_rz > 0 ? std::sqrt(std::abs(rz) / first_rz) : 0;
}

}  // namespace

SolverReport solve_laplace(const LayeredMesh& mesh, std::vector<float>& u,
                           const LaplaceOptions& options, const Progress& progress) {
  const bool uniform = mesh.layers > 1 && is_uniform(mesh);
  Stiffness stiffness = assemble_stiffness(mesh, uniform);
  LevelMatrix& matrix = stiffness.matrix;
  matrix.given_top = options.fixed_top;
  PaddedFloats r = complete_diagonal(mesh, u, matrix);
  SolverReport report;
  report.unknowns = impose_given(mesh, options.fixed_top, matrix, r);
  invert_pivots(matrix, mesh.vertex_count());
  ConjugateGradients(mesh, matrix, std::move(r), std::move(stiffness.weights))
      .solve(options, progress, u, report);
  return report;
}

}  // namespace tetropolis
