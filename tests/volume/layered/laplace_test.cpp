#include "volume/layered/laplace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "support/small_city.h"
#include "support/test_data.h"
#include "volume/layered/laplace_bands.h"
#include "volume/layered/laplace_coarsen.h"
#include "volume/layered/laplace_galerkin.h"
#include "volume/layered/laplace_multigrid.h"

namespace tetropolis {
namespace {

using Matrix = std::vector<std::vector<double>>;

std::size_t index_of(const LayeredMesh& mesh, const std::pair<VertexIndex, std::int32_t>& node) {
  return static_cast<std::size_t>(node.first) * mesh.stride() +
         static_cast<std::size_t>(node.second);
}

using Node = std::pair<VertexIndex, std::int32_t>;
using TetMatrix = std::array<std::array<double, 4>, 4>;

/// Linear finite elements the textbook way: gradients from the inverse of the tet's edge matrix.
TetMatrix tet_stiffness(const LayeredMesh& mesh, const std::array<Node, 4>& tet) {
  std::array<std::array<double, 3>, 4> p;
  for (std::size_t i = 0; i < 4; ++i) {
    const VertexIndex v = tet[i].first;
    p[i] = {mesh.ground.vertices[v].x, mesh.ground.vertices[v].y, mesh.column(v)[tet[i].second]};
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
  TetMatrix matrix;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      matrix[i][j] =
          std::abs(det) / 6 * (g[i][0] * g[j][0] + g[i][1] * g[j][1] + g[i][2] * g[j][2]);
  return matrix;
}

Matrix dense_stiffness(const LayeredMesh& mesh) {
  Matrix a(mesh.z.size(), std::vector<double>(mesh.z.size(), 0.0));
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::int32_t k = mesh.first_layer[t]; k < mesh.layers; ++k)
      for (const auto& tet : testing::prism_tets(mesh, t, k)) {
        const TetMatrix cell = tet_stiffness(mesh, tet);
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j)
            a[index_of(mesh, tet[i])][index_of(mesh, tet[j])] += cell[i][j];
      }
  return a;
}

/// Whether solve_laplace takes the value of node (v, k) from its argument.
bool is_given(const LayeredMesh& mesh, std::size_t v, std::int32_t k, bool fixed_top) {
  return k <= mesh.first_node[v] || k == mesh.roof_layer[v] || (fixed_top && k == mesh.layers);
}

LayeredMesh small_mesh(double mesh_size = 30) {
  testing::SmallCity city = testing::small_city(testing::hills);
  city.footprints.resize(2);
  city.roofs.resize(2);
  return testing::layered(city, mesh_size).mesh;
}

/// The matrix of a level with all rows, given ones too.
Matrix dense_matrix(const LevelMatrix& a, const LevelGraph& graph) {
  const std::size_t n = a.rows, m = a.band();
  Matrix dense(graph.columns * n, std::vector<double>(graph.columns * n, 0.0));
  const auto couple = [&](std::size_t v, std::size_t k, std::size_t x, std::size_t l, float value) {
    if (k >= n || l >= n) return;
    dense[v * n + k][x * n + l] += static_cast<double>(value);
    dense[x * n + l][v * n + k] += static_cast<double>(value);
  };
  for (std::size_t v = 0; v < graph.columns; ++v) {
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = v * m + a.in_band(k);
      couple(v, k, v, k + 1, a.vertical[i]);
      dense[v * n + k][v * n + k] += static_cast<double>(a.diagonal[i]);
    }
    for (const EdgeIndex e : graph.starting_at(v)) {
      const VertexIndex x = graph.edges[e][1];
      const float* bands = a.edge.data() + e * a.bands * m;
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = a.in_band(k);
        couple(v, k, x, k, bands[i]);
        couple(v, k, x, k + 1, bands[m + i]);
        if (a.bands == 3) couple(v, k + 1, x, k, bands[2 * m + i]);
      }
    }
  }
  return dense;
}

LevelGraph graph_of(const LayeredMesh& mesh) { return LevelGraph(mesh.edges); }

/// Evenly layered and untrimmed, as the first solve finds it.
LayeredMesh even_mesh(double mesh_size) {
  GroundMesh ground = small_mesh(mesh_size).ground;
  return make_layers(std::move(ground), 7, 100.0, 163.0);
}

TEST(Laplace, BandsAreTheFiniteElementMatrixOfTheRealTets) {
  const LayeredMesh mesh = small_mesh();
  const Matrix dense = dense_stiffness(mesh);
  auto [matrix, weights] = assemble_stiffness(mesh, false);
  complete_diagonal(mesh, std::vector<float>(mesh.z.size(), 0.0F), matrix);
  const Matrix banded = dense_matrix(matrix, graph_of(mesh));
  double largest = 0;
  for (std::size_t i = 0; i < dense.size(); ++i) largest = std::max(largest, dense[i][i]);
  for (std::size_t i = 0; i < dense.size(); ++i)
    for (std::size_t j = 0; j < dense.size(); ++j)
      ASSERT_NEAR(banded[i][j], dense[i][j], 1e-5 * largest) << i << " " << j;
}

TEST(Laplace, EvenLayersHaveTwoNumbersForABand) {
  const LayeredMesh mesh = even_mesh(30);
  EXPECT_TRUE(is_uniform(mesh));
  EXPECT_FALSE(is_uniform(small_mesh()));
  const Matrix dense = dense_stiffness(mesh);
  auto [matrix, weights] = assemble_stiffness(mesh, true);
  complete_diagonal(mesh, std::vector<float>(mesh.z.size(), 0.0F), matrix);
  const Matrix banded = dense_matrix(matrix, graph_of(mesh));
  double largest = 0;
  for (std::size_t i = 0; i < dense.size(); ++i) largest = std::max(largest, dense[i][i]);
  const std::size_t n = mesh.stride();
  for (std::size_t i = 0; i < dense.size(); ++i) {
    if (i % n == 0) continue;  // the bottom is given
    for (std::size_t j = 0; j < dense.size(); ++j)
      ASSERT_NEAR(banded[i][j], dense[i][j], 1e-5 * largest) << i << " " << j;
  }
}

TEST(Laplace, TheFirstResidualIsMinusTheProduct) {
  std::mt19937 random(testing::test_seed());
  for (const bool uniform : {false, true}) {
    const LayeredMesh mesh = uniform ? even_mesh(30) : small_mesh();
    const Matrix dense = dense_stiffness(mesh);
    std::vector<float> u(mesh.z.size());
    for (float& value : u) value = static_cast<float>(random() % 1000) / 100.0F;
    auto [matrix, weights] = assemble_stiffness(mesh, uniform);
    const PaddedFloats r = complete_diagonal(mesh, u, matrix);
    const std::size_t n = mesh.stride();
    for (std::size_t i = 0; i < dense.size(); ++i) {
      if (uniform && i % n == 0) continue;
      double expected = 0;
      for (std::size_t j = 0; j < dense.size(); ++j)
        expected -= dense[i][j] * static_cast<double>(u[j]);
      ASSERT_NEAR(r[i / n * matrix.stride + i % n], expected, 1e-5 * 1e4) << i;
    }
  }
}

TEST(Laplace, CoarseLevelsAreGalerkinProducts) {
  for (const bool uniform : {false, true}) {
    const LayeredMesh mesh = uniform ? even_mesh(20) : small_mesh(20);
    auto [matrix, weights] = assemble_stiffness(mesh, uniform);
    complete_diagonal(mesh, std::vector<float>(mesh.z.size(), 0.0F), matrix);
    LevelGraph graph = graph_of(mesh);
    std::vector<CoarseLevel> levels;
    levels.reserve(2);
    for (int step = 0; step < 2; ++step) {  // from two bands an edge to three, and on
      const LevelMatrix& fine = step == 0 ? matrix : levels.back().matrix;
      const Interpolation p = coarsen(graph, step == 0 ? weights : levels.back().weights);
      const std::size_t columns = p.fine.size(), n = matrix.rows;
      EXPECT_LT(columns * 3, graph.columns);
      const Matrix a = dense_matrix(fine, graph);
      Matrix ap(a.size(), std::vector<double>(columns * n, 0.0));
      Matrix expected(columns * n, std::vector<double>(columns * n, 0.0));
      for (std::size_t x = 0; x < graph.columns; ++x) {
        float sum = 0;
        for (const auto& entry : p.coarse[x]) {
          sum += entry.weight;
          for (std::size_t row = 0; row < a.size(); ++row)
            for (std::size_t k = 0; k < n; ++k)
              ap[row][entry.column * n + k] +=
                  a[row][x * n + k] * static_cast<double>(entry.weight);
        }
        EXPECT_NEAR(sum, 1, 1e-5) << "constants";
      }
      for (std::size_t c = 0; c < columns; ++c)
        for (const auto& entry : p.fine[c]) {
          for (std::size_t k = 0; k < n; ++k)
            for (std::size_t j = 0; j < columns * n; ++j)
              expected[c * n + k][j] +=
                  ap[entry.column * n + k][j] * static_cast<double>(entry.weight);
        }
      levels.push_back(coarse_level(fine, graph, p));
      graph = levels.back().graph.view();
      const Matrix coarse = dense_matrix(levels.back().matrix, graph);
      double largest = 0;
      for (std::size_t i = 0; i < coarse.size(); ++i) largest = std::max(largest, expected[i][i]);
      for (std::size_t i = 0; i < coarse.size(); ++i)
        for (std::size_t j = 0; j < coarse.size(); ++j)
          ASSERT_NEAR(coarse[i][j], expected[i][j], 1e-5 * largest) << i << " " << j;
    }
  }
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
    if (!is_given(mesh, v, k, fixed_top)) continue;
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
  std::mt19937 random(testing::test_seed());
  for (const LayeredMesh& mesh : {small_mesh(), even_mesh(30)}) {
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
        const bool fixed = is_given(mesh, v, k, fixed_top);
        unknowns += fixed ? 0 : 1;
        if (fixed) {
          ASSERT_EQ(u[i], guess[i]);
        }
      }
      EXPECT_EQ(report.unknowns, unknowns);
    }
  }
}

/// The plainest solver there is: conjugate gradients in double precision on the tets one by one.
std::vector<double> plain_solve(const LayeredMesh& mesh, const std::vector<float>& guess,
                                bool fixed_top) {
  struct Cell {
    std::array<std::size_t, 4> nodes;
    std::array<std::array<double, 4>, 4> matrix;
  };
  std::vector<Cell> cells;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::int32_t k = mesh.first_layer[t]; k < mesh.layers; ++k)
      for (const auto& tet : testing::prism_tets(mesh, t, k))
        cells.push_back({{index_of(mesh, tet[0]), index_of(mesh, tet[1]), index_of(mesh, tet[2]),
                          index_of(mesh, tet[3])},
                         tet_stiffness(mesh, tet)});
  const std::size_t n = mesh.stride();
  std::vector<double> u(guess.begin(), guess.end());
  const auto product = [&](const std::vector<double>& x) {
    std::vector<double> y(x.size(), 0.0);
    for (const Cell& cell : cells)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          y[cell.nodes[i]] += cell.matrix[i][j] * x[cell.nodes[j]];
    for (std::size_t i = 0; i < y.size(); ++i)
      if (is_given(mesh, i / n, static_cast<std::int32_t>(i % n), fixed_top)) y[i] = 0;
    return y;
  };
  const auto dot = [](const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
    return sum;
  };
  std::vector<double> r = product(u), p(u.size(), 0.0);
  for (double& value : r) value = -value;
  double rr = dot(r, r), previous = 1, beta = 0;
  for (const double target = 1e-20 * rr; rr > target; beta = rr / previous) {
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = r[i] + beta * p[i];
    const std::vector<double> q = product(p);
    const double alpha = rr / dot(p, q);
    for (std::size_t i = 0; i < p.size(); ++i) {
      u[i] += alpha * p[i];
      r[i] -= alpha * q[i];
    }
    previous = rr;
    rr = dot(r, r);
  }
  return u;
}

TEST(Laplace, AgreesWithPlainConjugateGradientsOnSeveralLevels) {
  std::mt19937 random(testing::test_seed());
  const auto check = [&](const LayeredMesh& mesh, bool fixed_top) {
    std::vector<float> u(mesh.z.size());
    for (float& value : u) value = static_cast<float>(random() % 1000) / 100.0F;
    const std::vector<double> expected = plain_solve(mesh, u, fixed_top);
    LaplaceOptions options;
    options.tolerance = 1e-6;
    options.fixed_top = fixed_top;
    const SolverReport report = solve_laplace(mesh, u, options);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.iterations, 20);
    for (std::size_t i = 0; i < u.size(); ++i)
      if (static_cast<std::int32_t>(i % mesh.stride()) >= mesh.first_node[i / mesh.stride()]) {
        ASSERT_NEAR(u[i], expected[i], 3e-4) << i;
      }
  };
  const LayeredMesh mesh = testing::layered(testing::small_city(testing::hills), 5).mesh;
  check(mesh, true);
  check(mesh, false);
  const LayeredMesh even = make_layers(mesh.ground, 9, 90.0, 190.0);
  check(even, true);
  check(even, false);
}

TEST(Laplace, IterationsDoNotGrowWithTheMesh) {
  std::vector<int> iterations;
  for (const double size : {10.0, 5.0, 2.5}) {
    testing::LayeredCity city = testing::layered(testing::small_city(testing::hills), size);
    std::vector<float> u(city.mesh.z.size(), 0.0F);
    for (std::size_t v = 0; v < city.mesh.vertex_count(); ++v)
      if (city.mesh.roof_layer[v] != kNoRoof)
        u[v * city.mesh.stride() + static_cast<std::size_t>(city.mesh.roof_layer[v])] = 3;
    const SolverReport report = solve_laplace(city.mesh, u, {});
    EXPECT_TRUE(report.converged);
    iterations.push_back(report.iterations);
  }
  for (const int count : iterations) EXPECT_LE(count, 8);
  EXPECT_LE(iterations[2], iterations[0] + 1);
}

TEST(Laplace, PreconditionerIsSymmetricAndPositive) {
  std::mt19937 random(testing::test_seed());
  for (const auto& [uniform, given_top] :
       {std::pair(false, true), {false, false}, {true, true}, {true, false}}) {
    const LayeredMesh mesh =
        uniform ? even_mesh(4) : testing::layered(testing::small_city(testing::hills), 4).mesh;
    auto [matrix, weights] = assemble_stiffness(mesh, uniform);
    matrix.given_top = given_top;
    complete_diagonal(mesh, std::vector<float>(mesh.z.size(), 0.0F), matrix);
    invert_pivots(matrix, mesh.vertex_count());
    const LevelGraph graph = graph_of(mesh);
    Multigrid multigrid(matrix, graph, weights, 80, 120.0 * 90.0);
    const std::size_t size = mesh.vertex_count() * matrix.stride;
    const auto random_vector = [&, &matrix = matrix] {
      PaddedFloats x(size);
      for (std::size_t i = 0; i < size; ++i)
        if (matrix.inverse_pivots[i] != 0) x[i] = static_cast<float>(random() % 2001) / 1e3F - 1;
      return x;
    };
    const auto apply = [&, &matrix = matrix](const PaddedFloats& b) {
      PaddedFloats x(size), y(size);
      solve_columns(matrix, multigrid.damping(), b.data(), x.data(), {0, mesh.vertex_count()});
      multigrid.apply_to_smoothed(b.data(), x.data(), y.data());
      return y;
    };
    const auto dot = [&](const PaddedFloats& x, const PaddedFloats& y) {
      double sum = 0;
      for (std::size_t i = 0; i < size; ++i)
        sum += static_cast<double>(x[i]) * static_cast<double>(y[i]);
      return sum;
    };
    const PaddedFloats a = random_vector(), b = random_vector();
    const PaddedFloats ma = apply(a), mb = apply(b);
    const double scale = std::sqrt(dot(a, ma) * dot(b, mb));
    EXPECT_GT(dot(a, ma), 0);
    EXPECT_GT(dot(b, mb), 0);
    EXPECT_NEAR(dot(a, mb), dot(b, ma), 1e-5 * scale);
  }
}

TEST(Laplace, SameBitsForAnyNumberOfThreads) {
  const LayeredMesh trimmed = testing::layered(testing::small_city(testing::hills), 3).mesh;
  const LayeredMesh even = make_layers(trimmed.ground, 20, 90.0, 190.0);
  for (const LayeredMesh* mesh : {&trimmed, &even}) {
    std::vector<std::vector<float>> results;
    for (const int threads : {1, 2, 3}) {
      const ThreadLimit limit(threads);
      std::vector<float> u(mesh->z.size());
      for (std::size_t i = 0; i < u.size(); ++i) u[i] = static_cast<float>(i % 97);
      solve_laplace(*mesh, u, {});
      results.push_back(u);
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
  }
}

TEST(Laplace, AFlatShiftIsSolvedAtOnce) {
  const LayeredMesh mesh = small_mesh(10);
  std::vector<float> u(mesh.z.size(), 12.5F);
  const SolverReport report = solve_laplace(mesh, u, {});
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  for (const float value : u) ASSERT_EQ(value, 12.5F);
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
