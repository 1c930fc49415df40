#include "tetropolis/volume/laplace.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tetropolis/core/parallel.h"

#include "laplace_bands.h"
#include "laplace_galerkin.h"
#include "laplace_multigrid.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerChunk = 256;

/// A solve that takes this many iterations has a bad smoother.
constexpr int kPatience = 40;

/// Clears the row of node (v, k) in the bands of v's column.
void clear_own(LevelMatrix& matrix, std::size_t v, std::size_t k) {
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
  const auto for_inner = [&](std::size_t v, const auto& body) {
    for (std::int32_t k = 1; k <= mesh.first_node[v]; ++k) body(static_cast<std::size_t>(k));
    if (mesh.roof_layer[v] > mesh.first_node[v]) body(static_cast<std::size_t>(mesh.roof_layer[v]));
  };
  const auto impose = [&](std::size_t begin, std::size_t end) {
    std::int64_t unknowns = 0;
    for (std::size_t v = begin; v < end; ++v) {
      std::size_t given = fixed_top ? 2 : 1;
      r[v * stride] = 0;
      if (fixed_top) r[v * stride + layers] = 0;
      for_inner(v, [&](std::size_t k) {
        r[v * stride + k] = 0;
        if (!fixed_top || k < layers) ++given;
        clear_own(matrix, v, k);
      });
      unknowns += static_cast<std::int64_t>(layers + 1 - given);
      for (EdgeIndex e = mesh.edges.starts[v]; e < mesh.edges.starts[v + 1]; ++e) {
        const auto i = static_cast<std::size_t>(e);
        const auto b = static_cast<std::size_t>(mesh.edges.vertices[i][1]);
        float* level = matrix.edge.data() + 2 * i * stride;
        float* rising = level + stride;
        for_inner(v, [&](std::size_t k) { level[k] = rising[k] = 0; });
        for_inner(b, [&](std::size_t k) { level[k] = rising[k - 1] = 0; });
      }
    }
    return unknowns;
  };
  return parallel_reduce_ordered(mesh.vertex_count(), kColumnsPerChunk, std::int64_t{0}, impose,
                                 [](std::int64_t a, std::int64_t b) { return a + b; });
}

double mean_height(const LayeredMesh& mesh) {
  double sum = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    sum += mesh.column(v)[mesh.layers] - mesh.column(v)[0];
  return sum / static_cast<double>(mesh.vertex_count());
}

double plan_area(const GroundMesh& ground) {
  double sum = 0;
  for (const auto& t : ground.triangles) {
    const Point2 a = ground.vertices[static_cast<std::size_t>(t[0])];
    const Point2 b = ground.vertices[static_cast<std::size_t>(t[1])];
    const Point2 c = ground.vertices[static_cast<std::size_t>(t[2])];
    sum += std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;
  }
  return sum;
}

}  // namespace

SolverReport solve_laplace(const LayeredMesh& mesh, std::vector<float>& u,
                           const LaplaceOptions& options, const Progress& progress) {
  const bool uniform = options.fixed_top && mesh.layers > 1 && is_uniform(mesh);
  Stiffness stiffness = assemble_stiffness(mesh, uniform);
  auto& matrix = stiffness.matrix;
  auto& weights = stiffness.weights;
  matrix.given_top = options.fixed_top;
  PaddedFloats r = complete_diagonal(mesh, u, matrix);
  SolverReport report;
  report.unknowns = impose_given(mesh, options.fixed_top, matrix, r);
  invert_pivots(matrix, mesh.vertex_count());
  const LevelGraph graph{mesh.vertex_count(), mesh.edges.vertices.data(), mesh.edges.starts.data(),
                         mesh.edges.end_offsets.data(), mesh.edges.ends.data()};
  Multigrid preconditioner(matrix, graph, std::move(weights), mean_height(mesh),
                           plan_area(mesh.ground));
  const std::size_t n = mesh.stride(), stride = matrix.stride;
  PaddedFloats p(r.size()), q(r.size()), z(r.size());

  const auto over_columns = [&](const auto& kernel) {
    parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
      kernel(ColumnRange{begin, end});
    });
  };
  // q = M^-1 r. The first half sweep of M needs nothing but the column's own residual, so it is
  // made where that is known.
  const auto smooth = [&](ColumnRange range) {
    solve_columns(matrix, preconditioner.damping(), r.data(), z.data(), range);
  };
  const auto precondition = [&] {
    return preconditioner.apply_to_smoothed(r.data(), z.data(), q.data());
  };
  const auto new_direction = [&](float beta) {  // p = q + beta p
    over_columns([&](ColumnRange range) {
      for (std::size_t i = range.begin * stride; i < range.end * stride; ++i)
        p[i] = q[i] + beta * p[i];
    });
  };
  const auto multiplied_direction = [&] {  // q = A p
    return parallel_reduce_ordered(
        mesh.vertex_count(), kColumnsPerChunk, 0.0,
        [&](std::size_t begin, std::size_t end) {
          return multiply(matrix, graph, p.data(), q.data(), {begin, end});
        },
        [](double a, double b) { return a + b; });
  };
  const auto step = [&](float alpha) {  // u += alpha p, r -= alpha q
    over_columns([&](ColumnRange range) {
      for (std::size_t v = range.begin; v < range.end; ++v)
        for (std::size_t k = 0; k < n; ++k) u[v * n + k] += alpha * p[v * stride + k];
      for (std::size_t i = range.begin * stride; i < range.end * stride; ++i) r[i] -= alpha * q[i];
      smooth(range);
    });
  };

  over_columns(smooth);
  double rz = precondition();
  // A sum of squares, unless the smoother does not converge on this mesh.
  const auto restart_safely = [&] {
    if (!preconditioner.make_safe()) return false;
    over_columns(smooth);
    rz = precondition();
    return rz > 0;
  };
  if (rz < 0) restart_safely();
  const double first_rz = rz, target = options.tolerance * options.tolerance * rz;
  report.converged = rz == 0;
  float beta = 0;
  while (rz > 0 && !report.converged && report.iterations < options.max_iterations) {
    progress.update(
        report.iterations == 0
            ? 0.0
            : std::clamp(std::log(rz / first_rz) / std::log(target / first_rz), 0.0, 1.0));
    new_direction(beta);
    const double pq = multiplied_direction();
    if (!(pq > 0)) break;  // rounding level reached: no direction reduces the energy any more
    step(static_cast<float>(rz / pq));
    ++report.iterations;
    const double next = precondition();
    beta = static_cast<float>(next / rz);
    rz = next;
    if (rz < 0 || report.iterations == kPatience) {
      if (!restart_safely() && rz < 0) break;
      beta = 0;
    }
    report.converged = rz <= target;
  }
  report.relative_residual = first_rz > 0 ? std::sqrt(std::abs(rz) / first_rz) : 0;
  return report;
}

}  // namespace tetropolis
