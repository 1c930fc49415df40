#include "tetropolis/volume/laplace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "tetropolis/core/parallel.h"

#include "laplace_bands.h"

// The hot loops run over contiguous bands and are compiled for wider vectors as well; products are
// never fused with sums, so every version rounds the same way. Sanitizers do not support resolving
// such functions at load time.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TETROPOLIS_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define TETROPOLIS_WIDE
#endif

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerChunk = 256;

/// Everything the kernels read, by plain pointers.
struct Operator {
  std::size_t n;  // nodes per column
  const float* edge;
  const float* vertical;
  const float* diagonal;
  const std::array<VertexIndex, 2>* edge_vertices;
  const EdgeIndex* starts;
  const std::int32_t* end_offsets;
  const EdgeIndex* ends;
};

struct ColumnRange {
  std::size_t begin, end;
};

/// y = A x for the columns of `range`; returns x.y over them. `lanes` holds n zeros on entry.
TETROPOLIS_WIDE double multiply(const Operator& a, const float* x, float* y, ColumnRange range,
                                double* lanes) {
  const std::size_t n = a.n;
  for (std::size_t v = range.begin; v < range.end; ++v) {
    float* __restrict yv = y + v * n;
    const float* xv = x + v * n;
    const float* diagonal = a.diagonal + v * n;
    const float* vertical = a.vertical + v * n;
    for (std::size_t k = 0; k < n; ++k) yv[k] = diagonal[k] * xv[k];
    for (std::size_t k = 0; k + 1 < n; ++k) yv[k] += vertical[k] * xv[k + 1];
    for (std::size_t k = 0; k + 1 < n; ++k) yv[k + 1] += vertical[k] * xv[k];
    for (EdgeIndex e = a.starts[v]; e < a.starts[v + 1]; ++e) {
      const float* level = a.edge + static_cast<std::size_t>(e) * 2 * n;
      const float* rising = level + n;
      const float* xb = x + static_cast<std::size_t>(a.edge_vertices[e][1]) * n;
      for (std::size_t k = 0; k < n; ++k) yv[k] += level[k] * xb[k];
      for (std::size_t k = 0; k + 1 < n; ++k) yv[k] += rising[k] * xb[k + 1];
    }
    for (std::int32_t i = a.end_offsets[v]; i < a.end_offsets[v + 1]; ++i) {
      const EdgeIndex e = a.ends[i];
      const float* level = a.edge + static_cast<std::size_t>(e) * 2 * n;
      const float* rising = level + n;
      const float* xa = x + static_cast<std::size_t>(a.edge_vertices[e][0]) * n;
      for (std::size_t k = 0; k < n; ++k) yv[k] += level[k] * xa[k];
      for (std::size_t k = 0; k + 1 < n; ++k) yv[k + 1] += rising[k] * xa[k];
    }
    for (std::size_t k = 0; k < n; ++k)
      lanes[k] += static_cast<double>(xv[k]) * static_cast<double>(yv[k]);
  }
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += lanes[k];
  return sum;
}

/// u += alpha p, r -= alpha q, z = M^-1 r (z may be q); returns r.z over the columns of `range`.
/// `pivots` are the inverse pivots of the columns' tridiagonal matrices.
TETROPOLIS_WIDE double step_and_precondition(const Operator& a, const float* pivots, float alpha,
                                             const float* p, float* u, float* r, float* q,
                                             ColumnRange range, double* lanes) {
  const std::size_t n = a.n;
  for (std::size_t v = range.begin; v < range.end; ++v) {
    const float* pv = p + v * n;
    float* uv = u + v * n;
    float* __restrict rv = r + v * n;
    float* __restrict qv = q + v * n;
    const float* vertical = a.vertical + v * n;
    const float* pivot = pivots + v * n;
    for (std::size_t k = 0; k < n; ++k) uv[k] += alpha * pv[k];
    for (std::size_t k = 0; k < n; ++k) rv[k] -= alpha * qv[k];
    // Thomas algorithm; the factor of row k is vertical[k - 1] * pivot[k - 1].
    float previous = rv[0];
    qv[0] = previous;
    for (std::size_t k = 1; k < n; ++k) {
      previous = rv[k] - vertical[k - 1] * pivot[k - 1] * previous;
      qv[k] = previous;
    }
    previous = qv[n - 1] * pivot[n - 1];
    qv[n - 1] = previous;
    for (std::size_t k = n - 1; k-- > 0;) {
      previous = (qv[k] - vertical[k] * previous) * pivot[k];
      qv[k] = previous;
    }
    for (std::size_t k = 0; k < n; ++k)
      lanes[k] += static_cast<double>(rv[k]) * static_cast<double>(qv[k]);
  }
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += lanes[k];
  return sum;
}

/// Layers of a column whose value is given.
bool is_fixed(const LayeredMesh& mesh, std::size_t v, std::int32_t k, bool fixed_top) {
  return k <= mesh.first_node[v] || k == mesh.roof_layer[v] || (fixed_top && k == mesh.layers);
}

/// Removes all couplings of fixed nodes; their rows become those of the identity. Returns the
/// number of nodes left unknown.
std::int64_t eliminate_fixed(const LayeredMesh& mesh, bool fixed_top, StiffnessBands& bands) {
  const std::size_t n = mesh.stride();
  const auto count_or_clear = [&](std::size_t begin, std::size_t end) {
    std::int64_t unknowns = 0;
    for (std::size_t v = begin; v < end; ++v) {
      float* vertical = bands.vertical.data() + v * n;
      for (std::size_t k = 0; k < n; ++k) {
        if (!is_fixed(mesh, v, static_cast<std::int32_t>(k), fixed_top)) {
          ++unknowns;
          continue;
        }
        bands.diagonal[v * n + k] = 1;
        vertical[k] = 0;
        if (k > 0) vertical[k - 1] = 0;
      }
      for (EdgeIndex e = mesh.edges.starts[v]; e < mesh.edges.starts[v + 1]; ++e) {
        const auto b =
            static_cast<std::size_t>(mesh.edges.vertices[static_cast<std::size_t>(e)][1]);
        float* level = bands.edge.data() + static_cast<std::size_t>(e) * 2 * n;
        float* rising = level + n;
        for (std::size_t k = 0; k < n; ++k) {
          const auto layer = static_cast<std::int32_t>(k);
          const bool fixed_a = is_fixed(mesh, v, layer, fixed_top);
          if (fixed_a || is_fixed(mesh, b, layer, fixed_top)) level[k] = 0;
          if (fixed_a || k + 1 == n || is_fixed(mesh, b, layer + 1, fixed_top)) rising[k] = 0;
        }
      }
    }
    return unknowns;
  };
  return parallel_reduce_ordered(mesh.vertex_count(), kColumnsPerChunk, std::int64_t{0},
                                 count_or_clear,
                                 [](std::int64_t a, std::int64_t b) { return a + b; });
}

std::vector<float> inverse_pivots(const LayeredMesh& mesh, const StiffnessBands& bands) {
  const std::size_t n = mesh.stride();
  std::vector<float> pivots(bands.diagonal.size());
  parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const float* vertical = bands.vertical.data() + v * n;
      pivots[v * n] = 1 / bands.diagonal[v * n];
      for (std::size_t k = 1; k < n; ++k)
        pivots[v * n + k] = 1 / (bands.diagonal[v * n + k] -
                                 vertical[k - 1] * vertical[k - 1] * pivots[v * n + k - 1]);
    }
  });
  return pivots;
}

/// Calls kernel(range, lanes) for all columns and adds up what it returns, in order.
template <typename Kernel>
double over_columns(const LayeredMesh& mesh, const Kernel& kernel) {
  return parallel_reduce_ordered(
      mesh.vertex_count(), kColumnsPerChunk, 0.0,
      [&](std::size_t begin, std::size_t end) {
        std::vector<double> lanes(mesh.stride(), 0.0);
        return kernel(ColumnRange{begin, end}, lanes.data());
      },
      [](double a, double b) { return a + b; });
}

Operator view(const LayeredMesh& mesh, const StiffnessBands& bands) {
  return {mesh.stride(),
          bands.edge.data(),
          bands.vertical.data(),
          bands.diagonal.data(),
          mesh.edges.vertices.data(),
          mesh.edges.starts.data(),
          mesh.edges.end_offsets.data(),
          mesh.edges.ends.data()};
}

/// r = -A u where u is unknown, 0 where it is fixed; A is the matrix before elimination.
std::vector<float> initial_residual(const LayeredMesh& mesh, const StiffnessBands& bands,
                                    const std::vector<float>& u, bool fixed_top) {
  std::vector<float> r(u.size());
  const Operator a = view(mesh, bands);
  over_columns(mesh, [&](ColumnRange range, double* lanes) {
    const double energy = multiply(a, u.data(), r.data(), range, lanes);
    for (std::size_t v = range.begin; v < range.end; ++v)
      for (std::size_t k = 0; k < a.n; ++k) {
        float& value = r[v * a.n + k];
        value = is_fixed(mesh, v, static_cast<std::int32_t>(k), fixed_top) ? 0.0F : -value;
      }
    return energy;
  });
  return r;
}

}  // namespace

SolverReport solve_laplace(const LayeredMesh& mesh, std::vector<float>& u,
                           const LaplaceOptions& options, const Progress& progress) {
  StiffnessBands bands = assemble_stiffness(mesh);
  std::vector<float> r = initial_residual(mesh, bands, u, options.fixed_top);
  SolverReport report;
  report.unknowns = eliminate_fixed(mesh, options.fixed_top, bands);
  const std::vector<float> pivots = inverse_pivots(mesh, bands);
  const Operator a = view(mesh, bands);
  std::vector<float> p(u.size(), 0.0F);
  std::vector<float> q(u.size(), 0.0F);

  const auto precondition = [&](float alpha) {
    return over_columns(mesh, [&](ColumnRange range, double* lanes) {
      return step_and_precondition(a, pivots.data(), alpha, p.data(), u.data(), r.data(), q.data(),
                                   range, lanes);
    });
  };
  const auto new_direction = [&](float beta) {  // p = q + beta p, q holding M^-1 r
    parallel_chunks(u.size(), kColumnsPerChunk * a.n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) p[i] = q[i] + beta * p[i];
    });
  };

  double rz = precondition(0);
  const double target = options.tolerance * options.tolerance * rz;
  const double first_rz = rz;
  report.converged = !(rz > target) || rz == 0;
  double beta = 0;
  while (!report.converged && report.iterations < options.max_iterations) {
    progress.update(
        report.iterations == 0
            ? 0.0
            : std::clamp(std::log(rz / first_rz) / std::log(target / first_rz), 0.0, 1.0));
    new_direction(static_cast<float>(beta));
    const double pq = over_columns(mesh, [&](ColumnRange range, double* lanes) {
      return multiply(a, p.data(), q.data(), range, lanes);
    });
    if (!(pq > 0)) break;  // rounding level reached: no direction reduces the energy any more
    const double next = precondition(static_cast<float>(rz / pq));
    beta = next / rz;
    rz = next;
    ++report.iterations;
    report.converged = rz <= target;
  }
  report.relative_residual = first_rz > 0 ? std::sqrt(std::max(rz, 0.0) / first_rz) : 0;
  return report;
}

}  // namespace tetropolis
