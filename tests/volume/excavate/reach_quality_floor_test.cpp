#include "volume/excavate/reach_quality_floor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/explicit_mesh.h"
#include "support/indices.h"
#include "support/small_city.h"
#include "support/test_data.h"
#include "volume/column/ground_heights.h"
#include "volume/excavate/places.h"

namespace tetropolis {
namespace {

ImprovedColumns improved(const testing::SmallCity& city, const GroundMesh& ground,
                         std::vector<double> spacing, const QualityFloorOptions& options) {
  Columns columns;
  columns.plan = plan_columns(ground, city.dtm, city.roofs, std::move(spacing), options.plan);
  columns.mesh = divide_columns(ground, build_edge_graph(ground), columns.plan);
  place_nodes(columns.mesh, columns.plan);
  const StepHooks hooks;
  std::vector<StepTime> times;
  Steps steps(hooks, times);
  return reach_quality_floor(std::move(columns), options, steps);
}

/// The ground is that of the terrain excavated from the sources told, each to its own slope. Walls
/// aside, which are lowered for other reasons.
void expect_excavated_as_told(const ImprovedColumns& result, const testing::SmallCity& city) {
  const GroundMesh& ground = result.columns.mesh.ground;
  const ColumnPlan& plan = result.columns.plan;
  const ExcavationSources& from = result.excavated;
  std::set<double> slopes(from.roof_slopes_deg.begin(), from.roof_slopes_deg.end());
  slopes.insert(from.toe_slopes_deg.begin(), from.toe_slopes_deg.end());
  std::vector<double> expected = terrain_under(ground, city.dtm);
  for (const double slope : slopes) {
    ExcavationMarks marks;
    marks.roofs.assign(city.roofs.size(), 0);
    marks.toes.assign(ground.vertices.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < from.roofs.size(); ++i)
      if (from.roof_slopes_deg[i] == slope)
        marks.roofs[static_cast<std::size_t>(from.roofs[i])] = 1;
    for (std::size_t i = 0; i < from.toes.size(); ++i)
      for (std::size_t v = 0; v < ground.vertices.size(); ++v)
        if (from.toe_slopes_deg[i] == slope && ground.vertices[v].x == from.toes[i][0] &&
            ground.vertices[v].y == from.toes[i][1])
          marks.toes[v] = from.toes[i][2];
    excavate(ground, plan.lowest_roof, city.roofs, marks, {std::tan(slope * std::acos(-1.0) / 180)},
             expected);
  }
  for (std::size_t v = 0; v < expected.size(); ++v) {
    if (plan.lowest_roof[v] == kNoRegion) {
      EXPECT_NEAR(plan.ground[v], expected[v], 1e-6);
    }
  }
}

/// A building sunk into the ground at one end of a long domain, and a hut at the other.
struct LongCity {
  static constexpr double kSize = 10;  // of the mesh
  static constexpr double kHere = 200, kFar = 550;

  testing::SmallCity city;
  GroundMesh ground;

  LongCity() {
    city.domain = {0, 0, 640, 100};
    city.footprints = {testing::rectangle(40, 40, 60, 60), testing::rectangle(570, 47, 576, 52)};
    city.roofs = {-10, 2.5};
    ground = mesh_ground(city.footprints, city.domain, {kSize, 25});
  }

  /// A rock wall of that height 2 m behind the hut (0: none), and nodes no further apart there.
  struct Far {
    double rock = 0;
    double spacing = kSize;
  };

  ImprovedColumns with(const Far& far) {
    city.dtm = testing::raster_of(city.domain, [&](double x, double) {
      return x < 20 ? 40.0 : x < 25 ? 8 * (25 - x) : x < 578 ? 0.0 : far.rock;
    });
    std::vector<double> spacing = column_spacing(ground);
    for (std::size_t v = 0; v < spacing.size(); ++v)
      if (ground.vertices[v].x > kFar) spacing[v] = std::min(spacing[v], far.spacing);
    QualityFloorOptions options;
    options.plan.domain_height = 80;
    options.plan.layer_height = kSize;
    options.work = 2'000'000;  // a little more than is needed here
    return improved(city, ground, std::move(spacing), options);
  }
};

/// The slopes of what was excavated on one side of the city.
std::set<double> slopes(const ImprovedColumns& result, bool far) {
  std::set<double> slopes;
  const ExcavationSources& from = result.excavated;
  for (std::size_t i = 0; i < from.roofs.size(); ++i)
    if ((from.roofs[i] == 1) == far) slopes.insert(from.roof_slopes_deg[i]);
  for (std::size_t i = 0; i < from.toes.size(); ++i)
    if ((from.toes[i][0] > LongCity::kFar) == far) slopes.insert(from.toe_slopes_deg[i]);
  return slopes;
}

/// What is done here does not depend on what is far away: that it is excavated, too, to gentler
/// slopes even, has very many thin cells, or takes all the work that a place may take.
TEST(ReachQualityFloor, WhatIsFarAwayChangesNothingHere) {
  LongCity city;
  const ImprovedColumns alone = city.with({});
  EXPECT_FALSE(slopes(alone, false).empty());
  EXPECT_TRUE(slopes(alone, true).empty());
  expect_excavated_as_told(alone, city.city);
  struct Case {
    LongCity::Far far;
    std::set<double> slopes;
    double thin_share;
  };
  for (const Case& c : {Case{{30}, {75}, 0}, Case{{38, 1}, {56}, 0.01}, Case{{0, 0.5}, {}, 0.01}}) {
    SCOPED_TRACE(::testing::Message() << c.far.rock << " " << c.far.spacing);
    const ImprovedColumns both = city.with(c.far);
    EXPECT_EQ(slopes(both, false), slopes(alone, false));
    EXPECT_EQ(slopes(both, true), c.slopes);
    expect_excavated_as_told(both, city.city);
    const CellQuality cells = measure_cells(both.columns.mesh);
    const std::int64_t thin = testing::count_bad_cells(both.columns.mesh, {kLeastOfMost, 180});
    EXPECT_GE(static_cast<double>(thin),
              c.thin_share * static_cast<double>(cells.histogram.cells()));
    const ColumnMesh &a = alone.columns.mesh, &b = both.columns.mesh;
    for (const VertexIndex v : different_columns(a, b))
      EXPECT_GT(a.ground.vertices[static_cast<std::size_t>(v)].x, LongCity::kHere);
  }
}

/// Two houses sunk so deep that what is excavated from one meets what is from the other, though
/// their faults lie apart.
TEST(ReachQualityFloor, PlacesGrowWhereExcavationsReachFurther) {
  testing::SmallCity city;
  city.domain = {0, 0, 110, 70};
  city.footprints = {testing::rectangle(30, 30, 38, 38), testing::rectangle(66, 30, 74, 38)};
  city.roofs = {-60, -60};
  city.dtm = testing::raster_of(city.domain, [](double, double) { return 0.0; });
  const GroundMesh ground = mesh_ground(city.footprints, city.domain, {2.5, 25});
  QualityFloorOptions options;
  options.plan.domain_height = 30;
  options.plan.layer_height = 2.5;
  const ImprovedColumns result = improved(city, ground, column_spacing(ground), options);
  EXPECT_EQ(result.excavated.roofs, (testing::indices_of<BuildingIndex>({0, 1})));
  expect_excavated_as_told(result, city);
}

/// A mesh without buildings, and edges between its vertices counted by brute force.
class PlacesTest : public ::testing::Test {
 protected:
  PlacesTest() {
    city.domain = {0, 0, 400, 100};
    city.dtm = testing::raster_of(city.domain, [](double, double) { return 0.0; });
    const testing::MeshedCity meshed = testing::meshed(city, 5);
    columns = {meshed.plan, meshed.mesh};
  }
  std::vector<int> edges_from(VertexIndex from) const {
    std::vector<int> edges(columns.mesh.vertex_count(), 1000);
    edges[static_cast<std::size_t>(from)] = 0;
    for (bool again = true; std::exchange(again, false);)
      for (const auto& [a, b] : columns.mesh.edges.vertices) {
        int &u = edges[static_cast<std::size_t>(a)], &v = edges[static_cast<std::size_t>(b)];
        again |= std::abs(u - v) > 1;
        u = std::min(u, v + 1);
        v = std::min(v, u + 1);
      }
    return edges;
  }

  testing::SmallCity city;
  Columns columns;
};

TEST_F(PlacesTest, HaveWhatIsNearTheirSeeds) {
  std::mt19937 random(testing::test_seed());
  std::size_t most = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const std::size_t n = columns.mesh.vertex_count();
    std::vector<std::uint8_t> seeds(n, 0);
    std::vector<VertexIndex> seeded;
    for (int i = 0; i < 6; ++i) {
      seeded.push_back(VertexIndex(std::uniform_int_distribution<std::size_t>(0, n - 1)(random)));
      seeds[static_cast<std::size_t>(seeded.back())] = 1;
    }
    std::vector<std::vector<int>> edges;
    for (const VertexIndex seed : seeded) edges.push_back(edges_from(seed));
    std::vector<int> place_of(n, -1);
    const auto places = find_places(columns, seeds);
    most = std::max(most, places.size());
    for (std::size_t p = 0; p < places.size(); ++p) {
      EXPECT_TRUE(std::is_sorted(places[p].begin(), places[p].end()));
      for (const VertexIndex v : places[p]) {
        EXPECT_EQ(std::exchange(place_of[static_cast<std::size_t>(v)], static_cast<int>(p)), -1);
      }
    }
    for (std::size_t v = 0; v < n; ++v) {
      int least = 1000;
      for (const auto& from : edges) least = std::min(least, from[v]);
      EXPECT_EQ(place_of[v] >= 0, least <= 16);
      bool is_of_nearest = false;
      for (std::size_t i = 0; i < seeded.size(); ++i)
        is_of_nearest |=
            edges[i][v] == least && place_of[v] == place_of[static_cast<std::size_t>(seeded[i])];
      EXPECT_TRUE(is_of_nearest || least > 16);
    }
    // Which seeds hang together.
    std::vector<std::size_t> together{0, 1, 2, 3, 4, 5};
    for (int round = 0; round < 6; ++round)
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j)
          if (edges[i][static_cast<std::size_t>(seeded[j])] <= 8)
            together[i] = together[j] = std::min(together[i], together[j]);
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        EXPECT_EQ(together[i] == together[j], place_of[static_cast<std::size_t>(seeded[i])] ==
                                                  place_of[static_cast<std::size_t>(seeded[j])]);
  }
  EXPECT_GT(most, 1U);
}

/// The cells over a free vertex, and those across an edge from them, are in the part.
TEST_F(PlacesTest, PartsAreRimmed) {
  std::vector<std::uint8_t> seeds(columns.mesh.vertex_count(), 0);
  seeds[seeds.size() / 2] = 1;
  const std::vector<VertexIndex> vertices = find_places(columns, seeds).at(0);
  ASSERT_LT(vertices.size(), seeds.size());
  const Cutout part = cut_out(columns, vertices);
  const EdgeGraph& edges = part.columns.mesh.edges;
  require_valid(part.columns.mesh);
  std::size_t free = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto whole = static_cast<std::size_t>(vertices[v]);
    EXPECT_EQ(part.columns.plan.ground[v], columns.plan.ground[whole]);
    EXPECT_EQ(part.columns.mesh.ground.vertices[v].x, columns.mesh.ground.vertices[whole].x);
    if (part.fixed[v] != 0) continue;
    ++free;
    const auto own = VertexIndex(v);
    const auto around = triangles_around(edges, {&own, 1});
    EXPECT_EQ(around.size(), triangles_around(columns.mesh.edges, {&vertices[v], 1}).size());
    for (const TriangleIndex t : around)
      for (const EdgeIndex e : edges.of_triangle[static_cast<std::size_t>(t)]) {
        const auto [a, b] = edges.vertices[static_cast<std::size_t>(e)];
        const bool on_rim = edges.triangles[static_cast<std::size_t>(e)][1] == kNoTriangle;
        const auto y = [&](VertexIndex u) {
          return part.columns.mesh.ground.vertices[static_cast<std::size_t>(u)].y;
        };
        const bool on_border = (y(a) == 0 && y(b) == 0) || (y(a) == 100 && y(b) == 100);
        EXPECT_TRUE(!on_rim || on_border);
      }
  }
  EXPECT_GT(free, 100U);
}

}  // namespace
}  // namespace tetropolis
