#include "tetropolis/volume/laplace.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/parallel.h"

#include "laplace_bands.h"
#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using Matrix = std::vector<std::vector<double>>;

std::size_t index_of(const LayeredMesh& mesh, const std::pair<VertexIndex, std::int32_t>& node) {
  return static_cast<std::size_t>(node.first) * mesh.stride() +
         static_cast<std::size_t>(node.second);
}

/// Linear finite elements the textbook way: gradients from the inverse of each tet's edge matrix.
Matrix dense_stiffness(const LayeredMesh& mesh) {
  Matrix a(mesh.z.size(), std::vector<double>(mesh.z.size(), 0.0));
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::int32_t k = mesh.first_layer[t]; k < mesh.layers; ++k)
      for (const auto& tet : testing::prism_tets(mesh, t, k)) {
        std::array<std::array<double, 3>, 4> p;
        for (std::size_t i = 0; i < 4; ++i) {
          const auto v = static_cast<std::size_t>(tet[i].first);
          p[i] = {mesh.ground.vertices[v].x, mesh.ground.vertices[v].y,
                  mesh.column(v)[tet[i].second]};
        }
        std::array<std::array<double, 3>, 3> e;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t d = 0; d < 3; ++d) e[i][d] = p[i + 1][d] - p[0][d];
        const auto cross = [](const std::array<double, 3>& x, const std::array<double, 3>& y) {
          return std::array<double, 3>{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2],
                                       x[0] * y[1] - x[1] * y[0]};
        };
        std::array<std::array<double, 3>, 4> g;
        g[1] = cross(e[1], e[2]);
        g[2] = cross(e[2], e[0]);
        g[3] = cross(e[0], e[1]);
        const double det = e[0][0] * g[1][0] + e[0][1] * g[1][1] + e[0][2] * g[1][2];
        for (std::size_t d = 0; d < 3; ++d) {
          for (std::size_t i = 1; i < 4; ++i) g[i][d] /= det;
          g[0][d] = -g[1][d] - g[2][d] - g[3][d];
        }
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j)
            a[index_of(mesh, tet[i])][index_of(mesh, tet[j])] +=
                std::abs(det) / 6 * (g[i][0] * g[j][0] + g[i][1] * g[j][1] + g[i][2] * g[j][2]);
      }
  return a;
}

LayeredMesh small_mesh() {
  testing::SmallCity city = testing::small_city(testing::hills);
  city.footprints.resize(2);
  city.roofs.resize(2);
  return testing::layered(city, 30).mesh;
}

TEST(Laplace, BandsAreTheFiniteElementMatrixOfTheRealTets) {
  const LayeredMesh mesh = small_mesh();
  const Matrix dense = dense_stiffness(mesh);
  const StiffnessBands bands = assemble_stiffness(mesh);
  const std::size_t n = mesh.stride();
  Matrix banded(mesh.z.size(), std::vector<double>(mesh.z.size(), 0.0));
  const auto couple = [&](std::size_t i, std::size_t j, float value) {
    if (i >= banded.size() || j >= banded.size()) return;
    banded[i][j] += static_cast<double>(value);
    banded[j][i] += static_cast<double>(value);
  };
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto a = static_cast<std::size_t>(mesh.edges.vertices[e][0]),
               b = static_cast<std::size_t>(mesh.edges.vertices[e][1]);
    for (std::size_t k = 0; k < n; ++k) {
      couple(a * n + k, b * n + k, bands.edge[2 * e * n + k]);
      if (k + 1 < n) {
        couple(a * n + k, b * n + k + 1, bands.edge[(2 * e + 1) * n + k]);
      } else {
        EXPECT_EQ(bands.edge[(2 * e + 1) * n + k], 0.0F);
      }
    }
  }
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for (std::size_t k = 0; k < n; ++k) {
      if (k + 1 < n) couple(v * n + k, v * n + k + 1, bands.vertical[v * n + k]);
      const bool without_cells = k < static_cast<std::size_t>(mesh.first_node[v]);
      banded[v * n + k][v * n + k] +=
          without_cells ? 0.0 : static_cast<double>(bands.diagonal[v * n + k]);
    }
  double largest = 0;
  for (std::size_t i = 0; i < dense.size(); ++i) largest = std::max(largest, dense[i][i]);
  for (std::size_t i = 0; i < dense.size(); ++i)
    for (std::size_t j = 0; j < dense.size(); ++j)
      ASSERT_NEAR(banded[i][j], dense[i][j], 1e-5 * largest) << i << " " << j;
}

/// Gaussian elimination on the unknowns.
std::vector<double> dense_solve(const LayeredMesh& mesh, const std::vector<float>& guess,
                                bool fixed_top) {
  Matrix a = dense_stiffness(mesh);
  std::vector<double> b(a.size(), 0.0);
  const std::size_t n = mesh.stride();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto v = i / n;
    const auto k = static_cast<std::int32_t>(i % n);
    const bool fixed =
        k <= mesh.first_node[v] || k == mesh.roof_layer[v] || (fixed_top && k == mesh.layers);
    if (!fixed) continue;
    a[i].assign(a.size(), 0.0);
    a[i][i] = 1;
    b[i] = static_cast<double>(guess[i]);
  }
  for (std::size_t c = 0; c < a.size(); ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c; r < a.size(); ++r)
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    std::swap(a[c], a[pivot]);
    std::swap(b[c], b[pivot]);
    for (std::size_t r = c + 1; r < a.size(); ++r) {
      const double factor = a[r][c] / a[c][c];
      if (factor == 0) continue;
      for (std::size_t j = c; j < a.size(); ++j) a[r][j] -= factor * a[c][j];
      b[r] -= factor * b[c];
    }
  }
  for (std::size_t c = a.size(); c-- > 0;) {
    for (std::size_t j = c + 1; j < a.size(); ++j) b[c] -= a[c][j] * b[j];
    b[c] /= a[c][c];
  }
  return b;
}

TEST(Laplace, SolvesTheDirichletProblemWithFixedAndFreeTop) {
  const LayeredMesh mesh = small_mesh();
  std::mt19937 random(testing::test_seed());
  std::vector<float> guess(mesh.z.size());
  for (float& value : guess)
    value = static_cast<float>(static_cast<double>(random() % 2000) / 100.0 - 10.0);
  for (const bool fixed_top : {true, false}) {
    LaplaceOptions options;
    options.tolerance = 1e-6;
    options.fixed_top = fixed_top;
    std::vector<float> u = guess;
    const SolverReport report = solve_laplace(mesh, u, options);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.relative_residual, 1e-6);
    const std::vector<double> expected = dense_solve(mesh, guess, fixed_top);
    std::int64_t unknowns = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      ASSERT_NEAR(u[i], expected[i], 2e-4) << i;
      const auto k = static_cast<std::int32_t>(i % mesh.stride());
      const std::size_t v = i / mesh.stride();
      const bool fixed =
          k <= mesh.first_node[v] || k == mesh.roof_layer[v] || (fixed_top && k == mesh.layers);
      unknowns += fixed ? 0 : 1;
      if (fixed) {
        ASSERT_EQ(u[i], guess[i]);
      }
    }
    EXPECT_EQ(report.unknowns, unknowns);
  }
}

TEST(Laplace, SameBitsForAnyNumberOfThreads) {
  const LayeredMesh mesh = testing::layered(testing::small_city(testing::hills), 3).mesh;
  std::vector<std::vector<float>> results;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    std::vector<float> u(mesh.z.size());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = static_cast<float>(i % 97);
    solve_laplace(mesh, u, {});
    results.push_back(u);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Laplace, ReportsWhatItCouldNotSolve) {
  const LayeredMesh mesh = testing::layered(testing::small_city(testing::hills), 4).mesh;
  std::vector<float> u(mesh.z.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = static_cast<float>(i % 97);
  LaplaceOptions options;
  options.max_iterations = 2;
  const SolverReport report = solve_laplace(mesh, u, options);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 2);
}

TEST(Laplace, StopsWhenAsked) {
  const LayeredMesh mesh = testing::layered(testing::small_city(testing::hills), 8).mesh;
  std::vector<float> u(mesh.z.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = static_cast<float>(i % 97);
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(solve_laplace(mesh, u, {}, progress), Cancelled);
}

}  // namespace
}  // namespace tetropolis
