#include "volume/column/fill_columns.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "support/errors.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

TEST(FillColumns, HeightsAreExactAndCellsValidOnAnyTerrain) {
  for (const auto& [name, terrain] : testing::kHardTerrains)
    for (const double size : {12.0, 5.0}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(size));
      const auto result = testing::meshed(testing::small_city(terrain), size);
      const ColumnMesh& mesh = result.mesh;
      EXPECT_EQ(measure_cells(mesh).histogram.inverted(), 0);
      EXPECT_GT(require_valid(mesh), 0);
      std::vector<bool> outside(mesh.vertex_count(), false);
      for (const TriangleIndex t : mesh.ground.triangles.indices())
        if (!mesh.inside_building(t))
          for (const VertexIndex v : mesh.ground.triangles[t])
            outside[static_cast<std::size_t>(v)] = true;
      for (const VertexIndex v : mesh.ground.vertices.indices()) {
        const double* z = mesh.z.data() + mesh.first[v];
        EXPECT_EQ(mesh.z[mesh.top(v)], result.plan.layers.top);
        if (outside[v]) {
          ASSERT_EQ(z[0], result.plan.ground[v]);
        }
        const bool at_building = result.plan.lowest_roof[v] != kNoRegion;
        ASSERT_EQ(mesh.regions[v].size(), (outside[v] ? 1U : 0U) + (at_building ? 1U : 0U));
        for (const RegionIndex r : mesh.regions[v]) {
          const Region& region = mesh.ground.regions[static_cast<std::size_t>(r)];
          const NodeIndex floor = mesh.floor(r, v);
          ASSERT_EQ(floor > mesh.first[v], region.is_building() && outside[v]);
          ASSERT_EQ(mesh.z[static_cast<std::size_t>(floor)],
                    region.is_building()
                        ? result.city.roofs[static_cast<std::size_t>(region.building)]
                        : result.plan.ground[v]);
        }
      }
    }
}

TEST(FillColumns, SpacingComesClosestToWhatWasAskedFor) {
  const auto result = testing::meshed(testing::small_city(testing::hills));
  const std::vector<double>& spacing = result.plan.spacing;
  const std::vector<double>& rise = result.plan.rise;
  for (const VertexIndex v : result.mesh.ground.vertices.indices()) {
    if (0.6 * rise[v] > spacing[v]) continue;  // the foot of a cliff
    const double* z = result.mesh.z.data() + result.mesh.first[v];
    const auto last = static_cast<std::int32_t>(result.mesh.top(v) - result.mesh.first[v]);
    const std::int32_t roof = std::ranges::max(result.mesh.floors_at(v));
    for (const auto& [low, high] : {std::pair(0, roof), std::pair(roof, last)}) {
      if (low == high) continue;
      const double height = z[high] - z[low];
      const std::int32_t count = high - low;
      const auto misfit = [&](std::int32_t n) { return std::abs(height / spacing[v] - n); };
      EXPECT_LE(misfit(count), misfit(count + 1));
      if (count > 1) {
        EXPECT_LE(misfit(count), misfit(count - 1));
      }
      for (std::int32_t i = low; i < high; ++i)
        EXPECT_NEAR(z[i + 1] - z[i], height / count, 1e-9 * height);
    }
  }
}

TEST(FillColumns, FirstSegmentsAtTheFootOfACliffReachItsEdge) {
  testing::SmallCity city =
      testing::small_city([](double x, double) { return x < 60 ? 0.0 : 20.0; });
  city.footprints.clear();
  city.roofs.clear();
  const auto result = testing::meshed(city, 4);
  const std::vector<double>& rise = result.plan.rise;
  int feet = 0;
  for (const VertexIndex v : result.mesh.ground.vertices.indices()) {
    double highest = 0;  // of the neighbours, by brute force
    for (const auto& t : result.mesh.ground.triangles)
      if (std::find(t.begin(), t.end(), VertexIndex(v)) != t.end())
        for (const VertexIndex u : t)
          highest = std::max(highest, result.plan.ground[static_cast<std::size_t>(u)]);
    EXPECT_EQ(rise[v], highest - result.plan.ground[v]);
    if (rise[v] < 20) continue;
    ++feet;
    const double* z = result.mesh.z.data() + result.mesh.first[v];
    EXPECT_EQ(z[0], 0);
    EXPECT_DOUBLE_EQ(z[1], 12);
    EXPECT_DOUBLE_EQ(z[2], 20);
  }
  EXPECT_GT(feet, 10);
  // Without these segments the cells at the cliff are slivers.
  ColumnPlan without = result.plan;
  without.rise.assign(without.rise.size(), 0);
  ColumnMesh plain = divide_columns(result.mesh.ground, result.mesh.edges, without);
  place_nodes(plain, without);
  const double least = measure_cells(result.mesh).histogram.min_dihedral_deg();
  EXPECT_GT(least, 6);
  EXPECT_GT(least, 2 * measure_cells(plain).histogram.min_dihedral_deg());
}

TEST(FillColumns, SpacingScalesWithTheTriangles) {
  const Bounds2 domain{0, 0, 120, 90};
  const GroundMesh open = mesh_ground({}, domain, {10, 25});
  const std::vector<double> spacing = column_spacing(open);
  EXPECT_GT(*std::min_element(spacing.begin(), spacing.end()), 4);
  EXPECT_LT(*std::max_element(spacing.begin(), spacing.end()), 12.5);
  GroundMesh half = open;
  for (Point2& p : half.vertices) p = {p.x / 2, p.y / 2};
  const std::vector<double> halved = column_spacing(half);
  for (std::size_t v = 0; v < spacing.size(); ++v) EXPECT_EQ(halved[v], spacing[v] / 2);
}

TEST(FillColumns, CellsAreGoodNextToFineDetailsAndOnSlopes) {
  // Gaps of 1 m between houses, at a tenth of the mesh size: uniform layers fall to about 3
  // degrees.
  testing::SmallCity city =
      testing::small_city([](double x, double y) { return 0.3 * x + 0.1 * y; });
  city.footprints[1] = testing::rectangle(39, 15, 55, 40);
  city.roofs[3] += 3;  // the low house would be a metre high on its upper side
  const auto result = testing::meshed(city, 10);
  const CellQuality quality = measure_cells(result.mesh, 5);
  EXPECT_GT(quality.histogram.min_dihedral_deg(), 12);
  EXPECT_LT(quality.histogram.max_dihedral_deg(), 155);
  const FaceQuality faces = measure_faces(result.mesh);
  EXPECT_LT(faces.worst.non_orthogonality_deg, 70);
  EXPECT_LT(faces.worst.skewness, 2);
}

TEST(FillColumns, RefusesHeightsThatDoNotIncrease) {
  auto city = testing::meshed(testing::small_city(testing::hills));
  city.plan.top[7] = city.plan.ground[7];
  const std::string message = testing::error_of(
      [&] { divide_columns(city.mesh.ground, city.mesh.edges, city.plan); }, ErrorKind::kGuarantee);
  EXPECT_NE(message.find("ground vertex 7"), std::string::npos) << message;
}

TEST(FillColumns, LayersKeepTheirHeights) {
  const auto layered = testing::layered(testing::small_city(testing::hills));
  const LayeredMesh& from = layered.mesh;
  const ColumnMesh mesh = columns_of_layers(LayeredMesh(from));
  EXPECT_GT(require_valid(mesh), 0);
  for (const VertexIndex v : from.ground.vertices.indices()) {
    ASSERT_EQ(mesh.first[v + 1] - mesh.first[v], from.layers + 1 - from.first_node[v]);
    for (std::int32_t k = from.first_node[v]; k <= from.layers; ++k)
      ASSERT_EQ(mesh.z[mesh.first[v] + k - from.first_node[v]], from.column(v)[k]);
    if (from.roof_layer[v] != kNoRoof) {
      ASSERT_EQ(std::ranges::max(mesh.floors_at(v)), from.roof_layer[v] - from.first_node[v]);
    }
  }
  EXPECT_EQ(measure_cells(mesh).histogram.inverted(), 0);
}

TEST(FillColumns, SameBitsForAnyNumberOfThreads) {
  std::vector<ColumnMesh> results;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    results.push_back(testing::meshed(testing::small_city(testing::hills), 1.5).mesh);
  }
  EXPECT_EQ(results[0].z, results[1].z);
  EXPECT_EQ(results[0].z, results[2].z);
  EXPECT_EQ(results[0].first, results[2].first);
}

TEST(FillColumns, ThePlanTellsGroundRoofsAndTop) {
  // A terrace: the house stands in front of a step of 6 m and reaches 0.5 m above its edge. The
  // terrain goes on beyond the mesh, where it has a mountain.
  testing::SmallCity city;
  city.domain = {0, 0, 60, 40};
  city.footprints = {testing::rectangle(20, 10, 40, 30)};
  city.roofs = {6.5};
  const auto terrain = [](double x, double) { return x < 30 ? 0.0 : x > 80 ? 500.0 : 6.0; };
  city.dtm = testing::raster_of({-10, -10, 100, 50}, terrain);
  const GroundMesh ground = mesh_ground(city.footprints, city.domain, {8, 25});
  for (const bool fit : {false, true}) {
    SCOPED_TRACE(fit);
    ColumnPlanOptions options;
    options.domain_height = 50;
    options.layer_height = 8;
    options.minimum_wall = 1;
    options.fit_lowered_walls = fit;
    const std::vector<double> spacing(ground.vertices.size(), 5.0);
    const ColumnPlan plan = plan_columns(ground, city.dtm, city.roofs, spacing, options);
    EXPECT_EQ(plan.layers.highest_ground, 6);
    EXPECT_EQ(plan.layers.top, 56);
    EXPECT_FALSE(plan.layers.raised);
    EXPECT_EQ(plan.spacing, spacing);
    std::int64_t lowered = 0;
    for (std::size_t v = 0; v < ground.vertices.size(); ++v) {
      const Point2 p = ground.vertices[v];
      const bool at_house = p.x >= 20 && p.x <= 40 && p.y >= 10 && p.y <= 30;
      EXPECT_EQ(plan.lowest_roof[v], at_house ? RegionIndex(0) : kNoRegion);
      EXPECT_EQ(plan.top[v], 56);
      // Inside the raster's cell of the step the ground is in between.
      if (p.x > 29 && p.x < 30) continue;
      const bool above = at_house && p.x >= 30;  // the roof is less than a metre above the ground
      const bool on_wall = p.x == 20 || p.x == 40 || p.y == 10 || p.y == 30;
      lowered += above && on_wall ? 1 : 0;
      EXPECT_EQ(plan.ground[v], above ? 6.5 - (fit ? 3.0 : 1.0) : terrain(p.x, p.y));
    }
    EXPECT_GT(lowered, 3);
    EXPECT_EQ(plan.lowered, lowered);
  }
  ColumnPlanOptions high;
  high.domain_height = 2;
  high.layer_height = 8;
  const ColumnPlan raised = plan_columns(ground, city.dtm, std::vector{30.0},
                                         std::vector<double>(ground.vertices.size(), 5), high);
  EXPECT_TRUE(raised.layers.raised);
  EXPECT_EQ(raised.layers.top, 46);
  EXPECT_EQ(raised.layers.highest_ground, 6);
}

TEST(FillColumns, CellsAtBuriedRoofsAreNoSlivers) {
  // A house of 10 m in a slope of 45 degrees: its roof is 4 m below the terrain behind it.
  testing::SmallCity city;
  city.footprints = {testing::rectangle(40, 30, 50, 50)};
  city.roofs = {46};
  city.dtm = testing::raster_of(city.domain, [](double x, double) { return x; });
  const auto result = testing::meshed(city);
  require_valid(result.mesh);
  EXPECT_GT(result.plan.lowered, 4);
  EXPECT_GT(measure_cells(result.mesh).histogram.min_dihedral_deg(), 8);
  // With walls of a metre they are.
  ColumnPlanOptions options;
  options.domain_height = 80;
  options.fit_lowered_walls = false;
  const ColumnPlan low = plan_columns(result.mesh.ground, city.dtm, city.roofs,
                                      column_spacing(result.mesh.ground), options);
  ColumnMesh thin = divide_columns(result.mesh.ground, result.mesh.edges, low);
  place_nodes(thin, low);
  EXPECT_LT(measure_cells(thin).histogram.min_dihedral_deg(), 5);
}

}  // namespace
}  // namespace tetropolis
