#include "volume/layered/smooth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "support/small_city.h"

namespace tetropolis {
namespace {

TEST(Smooth, MeshIsValidAndHeightsAreExactOnAnyTerrain) {
  for (const auto& [name, terrain] : testing::kHardTerrains)
    for (const double size : {12.0, 5.0})
      for (const bool fixed_top : {true, false}) {
        SCOPED_TRACE(std::string(name) + " " + std::to_string(size) +
                     (fixed_top ? " flat top" : " free top"));
        auto city = testing::small_city(terrain);
        const auto result = testing::layered(city, size, fixed_top);
        const LayeredMesh& mesh = result.mesh;
        for (const VertexIndex v : mesh.ground.vertices.indices()) {
          for (std::int32_t k = mesh.first_node[v]; k < mesh.layers; ++k)
            ASSERT_GT(mesh.column(v)[k + 1], mesh.column(v)[k]);
          if (mesh.first_node[v] == 0) {
            ASSERT_EQ(mesh.column(v)[0], result.plan.ground[v]);
          }
          if (result.plan.lowest_roof[v] != kNoRegion) {
            ASSERT_EQ(mesh.column(v)[mesh.roof_layer[v]], city.roofs[result.plan.lowest_roof[v]]);
          }
        }
      }
}

TEST(Smooth, TopStaysFlatWhenFixed) {
  const auto result = testing::layered(testing::small_city(testing::hills));
  double top = 0;
  for (const double z : result.city.dtm.values) top = std::max(top, z + 80);
  for (const double roof : result.city.roofs) top = std::max(top, roof + 2 * 8);
  for (const VertexIndex v : result.mesh.ground.vertices.indices())
    EXPECT_EQ(result.mesh.column(v)[result.mesh.layers], top);
}

TEST(Smooth, FlatTerrainWithRoofsOnLayersNeedsNoChange) {
  auto city = testing::small_city([](double, double) { return 0.0; });
  city.roofs = {16, 32, 16, 8, 64};
  const auto result = testing::layered(city, 8);
  for (const VertexIndex v : result.mesh.ground.vertices.indices())
    for (std::int32_t k = result.mesh.first_node[v]; k <= result.mesh.layers; ++k)
      EXPECT_NEAR(result.mesh.column(v)[k], 8.0 * k, 1e-4);
}

TEST(Smooth, PlansLayersForTheDomainAndItsRoofs) {
  const std::vector<double> ground{0, 10};
  const LayerPlan plan = plan_layers(ground, std::vector<double>{50.0}, 10, 100, 10);
  EXPECT_EQ(plan.top, 110);
  EXPECT_EQ(plan.bottom, 5);
  EXPECT_EQ(plan.layers, 11);  // 105 m in layers of about 10 m
  EXPECT_FALSE(plan.raised);
  const LayerPlan tower = plan_layers(ground, std::vector<double>{300.0}, 10, 100, 10);
  EXPECT_EQ(tower.top, 320);
  EXPECT_TRUE(tower.raised);
}

TEST(Smooth, CutsEachBuildingAtTheLayerNearestItsRoof) {
  auto city = testing::small_city([](double, double) { return 0.0; });
  city.roofs = {3, 9, 13, 20.5, 75};  // layers of 91 m / 11
  const auto result = testing::layered(city, 8);
  const std::vector<std::int32_t> nearest{1, 1, 2, 3,
                                          9};  // 20.5 m: 2.48 layers, in ratio closer to 3
  for (const TriangleIndex t : result.mesh.ground.triangles.indices()) {
    const BuildingIndex b = result.mesh.ground.region_of(t).building;
    EXPECT_EQ(result.mesh.first_layer[t], b == kNoBuilding ? 0 : nearest[b]);
  }
}

TEST(Smooth, OnALadderRoofsBesideASlotAreCutWhereTheirLayersMeet) {
  // The first house's roof is nearest to layer 3 in ratio, by its wall on the far side; in the slot
  // of a metre, where the ground is lower, to layer 4, as the other's is.
  const auto ground_at = [](double x, double) {
    return x < 46 ? std::min((46 - x) / 4, 3.0) : 0.0;
  };
  auto city = testing::small_city(ground_at);
  city.footprints = {testing::rectangle(30, 30, 46, 45), testing::rectangle(47, 30, 60, 45)};
  city.roofs = {4.1, 4.1};
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {5, 25});
  const ColumnPlan plan = testing::plan_of(city, ground, 5, true);
  LayeredMesh mesh = make_layers(std::move(ground),
                                 {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 20, 40, 60, plan.layers.top});
  smooth_to_ground(mesh, plan.ground, {});
  LayeredMesh alone = mesh;
  trim(mesh, plan.lowest_roof, city.roofs);
  alone.ladder.clear();  // as layers that are not a ladder are
  trim(alone, plan.lowest_roof, city.roofs);
  const auto layers_of = [](const LayeredMesh& of) {
    std::array<std::int32_t, 2> layers{};
    for (const TriangleIndex t : of.ground.triangles.indices())
      if (of.ground.inside_building(t)) layers[of.ground.region_of(t).building] = of.first_layer[t];
    return layers;
  };
  EXPECT_EQ(layers_of(alone), (std::array{2, 4}));
  EXPECT_EQ(layers_of(mesh), (std::array{4, 4}));
}

TEST(Smooth, OnALadderRoofsFarAboveEachOtherAcrossASlotAreCutAtDifferentLayers) {
  // Terraced houses: where slopes to layers that can move count in full both are cut at layer 3,
  // and cells in the slot are between two roofs, 5.4 m apart, and can not be helped.
  const auto ground_at = [](double x, double) { return 0.3 * std::max(0.0, x - 20); };
  auto city = testing::small_city(ground_at);
  city.footprints = {testing::rectangle(30, 30, 44, 45), testing::rectangle(48, 30, 62, 45)};
  city.roofs = {ground_at(44, 0) + 2, ground_at(62, 0) + 2};
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {5, 25});
  const ColumnPlan plan = testing::plan_of(city, ground, 5, true);
  LayeredMesh mesh = make_layers(std::move(ground), {0, 1, 2.2, 3.7, 5.5, 7.5, 10, 13, 16, 19, 22,
                                                     25, 30, 40, 60, plan.layers.top});
  smooth_to_ground(mesh, plan.ground, {});
  trim(mesh, plan.lowest_roof, city.roofs);
  std::array<std::int32_t, 2> layers{};
  for (const TriangleIndex t : mesh.ground.triangles.indices())
    if (mesh.ground.inside_building(t))
      layers[mesh.ground.region_of(t).building] = mesh.first_layer[t];
  EXPECT_EQ(layers, (std::array{2, 3}));
}

TEST(Smooth, SameBitsForAnyNumberOfThreads) {
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    results.push_back(testing::layered(testing::small_city(testing::hills), 3).mesh.z);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace tetropolis
