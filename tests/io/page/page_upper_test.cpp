// The steps that a page holds make the cells above the lid again: by a front that is a plain list
// of triangles.
#include "io/page/page_upper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "io/page/page_columns.h"
#include "support/small_city.h"
#include "volume/upper/grow_upper.h"
#include "volume/upper/lid.h"

namespace tetropolis {
namespace {

using Cell = std::array<std::int64_t, 4>;

ColumnMesh grown(double (*terrain)(double, double), double mesh_size) {
  testing::MeshedCity city = testing::meshed(testing::small_city(terrain), mesh_size);
  lower_tops(city.mesh.ground, city.mesh.edges, city.plan);
  city.mesh = divide_columns(std::move(city.mesh.ground), std::move(city.mesh.edges), city.plan);
  place_nodes(city.mesh, city.plan);
  city.mesh.upper = grow_upper(city.mesh, city.plan.layers.top);
  return std::move(city.mesh);
}

/// Elevations of columns in steps of the page.
std::vector<double> rounded(const ColumnMesh& mesh) {
  std::vector<double> z;
  for (const double metres : mesh.z) z.push_back(page_steps(metres));
  return z;
}

struct Climbed {
  std::vector<std::int64_t> z;  ///< Per node above.
  std::multiset<Cell> cells;    ///< Nodes ascending.
};

/// As page_upper.h says.
Climbed climb(const ColumnMesh& mesh, const std::vector<double>& z, const PageUpper& told) {
  struct Step {
    std::int64_t key;
    std::size_t vertex;
    std::int64_t node, to;  // to: -1 if it ends
  };
  Climbed result;
  std::vector<Step> steps;
  std::vector<std::int64_t> at(mesh.vertex_count());
  std::size_t wait = 0;
  std::int64_t count = 0, top = 0, node = mesh.column_nodes();
  for (std::size_t v = 0; v < at.size(); ++v) {
    const std::int64_t lid = mesh.top(VertexIndex(v)).value();
    at[v] = lid;
    std::int64_t below = std::llround(z[static_cast<std::size_t>(lid) - 1]);
    std::int64_t here = std::llround(z[static_cast<std::size_t>(lid)]), own = lid;
    count += told.count[v];
    const auto add = [&](std::int64_t ahead, std::int64_t to) {
      const std::int64_t eighth = std::max<std::int64_t>(1, ahead / 8);
      steps.push_back({2 * here + ahead + eighth * told.wait[wait++], v, own, to});
    };
    for (std::int64_t k = 0; k < count / 2; ++k) {
      const bool is_last = k + 1 == count / 2 && count % 2 == 0;
      const std::int64_t guess = is_last ? top : here + (here - below);
      const std::int64_t up = guess + told.rise[result.z.size()];
      if (is_last) top = up;
      add(up - here, node);
      result.z.push_back(up);
      below = std::exchange(here, up);
      own = node++;
    }
    if (count % 2 == 1) add((here - below) * 9 / 5, -1);
  }
  EXPECT_EQ(wait, told.wait.size());
  EXPECT_EQ(result.z.size(), told.rise.size());
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return std::tie(a.key, a.vertex, a.node) < std::tie(b.key, b.vertex, b.node);
  });

  using Corners = std::array<std::size_t, 3>;
  std::vector<std::set<Corners>> around(at.size());
  const auto each_corner = [&](const Corners& c, const auto& visit) {
    for (const std::size_t v : c) visit(around[v]);
  };
  for (const auto& t : mesh.ground.triangles) {
    const Corners c{t[0], t[1], t[2]};
    each_corner(c, [&](std::set<Corners>& set) { set.insert(c); });
  }
  const auto make = [&](Cell cell) {
    std::sort(cell.begin(), cell.end());
    result.cells.insert(cell);
  };
  std::size_t split = 0;
  for (const Step& step : steps) {
    const std::set<Corners> star = around[step.vertex];
    if (star.empty()) throw std::runtime_error("a step of a column that has ended");
    if (step.to >= 0) {
      for (const Corners& c : star) make({at[c[0]], at[c[1]], at[c[2]], step.to});
      at[step.vertex] = step.to;
      continue;
    }
    std::vector<std::pair<std::size_t, std::size_t>> sides;
    for (const Corners& c : star) {
      each_corner(c, [&](std::set<Corners>& set) { set.erase(c); });
      const std::size_t k = c[0] == step.vertex ? 0 : c[1] == step.vertex ? 1 : 2;
      sides.emplace_back(c[(k + 1) % 3], c[(k + 2) % 3]);
    }
    std::vector<std::size_t> ring{std::min_element(sides.begin(), sides.end())->first};
    while (ring.size() < sides.size()) {
      const auto next = std::find_if(sides.begin(), sides.end(),
                                     [&](const auto& side) { return side.first == ring.back(); });
      if (next == sides.end()) throw std::runtime_error("the end of a column at the rim");
      ring.push_back(next->second);
    }
    const auto cover = [&](const auto& self, std::size_t i, std::size_t j) -> void {
      if (j - i < 2) return;
      const std::size_t k = i + 1 + (j - i > 2 ? told.splits[split++] : 0U);
      const Corners c{ring[i], ring[k], ring[j]};
      each_corner(c, [&](std::set<Corners>& set) { set.insert(c); });
      make({step.node, at[c[0]], at[c[1]], at[c[2]]});
      self(self, i, k);
      self(self, k, j);
    };
    cover(cover, 0, ring.size() - 1);
  }
  EXPECT_EQ(split, told.splits.size());
  return result;
}

TEST(PageUpper, MakesTheCellsOfTheMesh) {
  for (const auto& [name, terrain] : testing::kHardTerrains)
    for (const double size : {12.0, 5.0}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(size));
      const ColumnMesh mesh = grown(terrain, size);
      ASSERT_FALSE(mesh.upper.empty());
      const std::vector<double> z = rounded(mesh);
      const PageUpper told = page_upper(mesh, z);
      const Climbed climbed = climb(mesh, z, told);
      ASSERT_EQ(climbed.z.size(), mesh.upper.nodes());
      for (std::size_t i = 0; i < climbed.z.size(); ++i)
        ASSERT_EQ(climbed.z[i], page_steps(mesh.upper.z[i]));
      std::multiset<Cell> cells;
      mesh.upper.for_each_cell(0, mesh.upper.cells(), [&](const UpperMesh::Cell& places) {
        const auto node = [&](std::size_t i) { return upper_node(mesh, places[i]).value(); };
        Cell cell{node(0), node(1), node(2), node(3)};
        std::sort(cell.begin(), cell.end());
        cells.insert(cell);
      });
      EXPECT_TRUE(climbed.cells == cells);
      // Some columns end, and most steps are taken when they are expected.
      EXPECT_GT(told.splits.size(), 0U);
      EXPECT_LT(std::count_if(told.wait.begin(), told.wait.end(), [](int w) { return w > 0; }),
                std::ssize(told.wait) / 2);
    }
}

TEST(PageUpper, IsEmptyWhereTheLidIsTheTop) {
  const ColumnMesh mesh = testing::meshed(testing::small_city(testing::hills)).mesh;
  const PageUpper told = page_upper(mesh, rounded(mesh));
  EXPECT_TRUE(told.count.empty());
  EXPECT_TRUE(told.rise.empty());
}

}  // namespace
}  // namespace tetropolis
