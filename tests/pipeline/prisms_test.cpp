// mesh_city with boundary layers, and with cells that are prisms alone.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/pipeline/mesh_city.h"

#include "support/small_city.h"

namespace tetropolis {
namespace {

CityMesh mesh_with(const testing::SmallCity& small, Cells cells, int layers = 0,
                   double cut_slope = 56) {
  MeshCityOptions options;
  options.cut_slope_deg = cut_slope;
  options.mesh_size = 8;
  options.cells = cells;
  options.boundary_layers.count = layers;
  return mesh_city(testing::city_model(small), small.dtm, options);
}

double gentle(double x, double y) { return 3 + 2 * std::sin(x / 20) * std::cos(y / 25); }

/// The volume above ground and roofs, as the boundary has them.
double volume_above_floors(const ColumnMesh& mesh, double top) {
  double volume = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const auto& v = mesh.ground.triangles[t];
    const Point2 a = mesh.ground.vertices[v[0]], b = mesh.ground.vertices[v[1]];
    const Point2 c = mesh.ground.vertices[v[2]];
    const double area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    for (const VertexIndex u : v)
      volume += area / 3 * (top - elevation(mesh, prism_node(mesh, t, u, 0)));
  }
  return volume;
}

TEST(Prisms, AloneFillTheDomainAboveExactFloors) {
  const testing::SmallCity city = testing::small_city(gentle);
  const CityMesh mesh = mesh_with(city, Cells::kPrisms);
  const VolumeMeshFacts& facts = mesh.volume_facts;
  EXPECT_TRUE(mesh.volume.layers.whole);
  EXPECT_EQ(mesh.volume.layers.count, 5);
  EXPECT_EQ(facts.cells, facts.prisms.cells);
  EXPECT_EQ(facts.cells, mesh.volume.layers.cells());
  EXPECT_EQ(facts.inverted, 0);
  EXPECT_TRUE(mesh.surface_facts.closed && mesh.surface_facts.manifold);
  EXPECT_NEAR(facts.volume / volume_above_floors(mesh.volume, facts.top), 1, 1e-9);
  EXPECT_GT(facts.prisms.share_as_asked, 0.97);
  EXPECT_LT(facts.prisms.max_non_orthogonality_deg, 60);
  EXPECT_LT(facts.prisms.max_skewness, 2);
  EXPECT_LT(facts.prisms.max_aspect_ratio, 60);
  for (const Warning& warning : mesh.warnings) EXPECT_NE(warning.code, "too_steep_for_prisms");
  // Roofs at their elevation, ground on the terrain.
  std::int64_t roofs = 0;
  for (const TriangleIndex t : mesh.volume.ground.triangles.indices())
    for (const VertexIndex v : mesh.volume.ground.triangles[t]) {
      const double z = elevation(mesh.volume, prism_node(mesh.volume, t, v, 0));
      const BuildingIndex b = mesh.volume.ground.region_of(t).building;
      const double wanted =
          b == kNoBuilding ? sample(city.dtm, mesh.volume.ground.vertices[v]) : city.roofs[b];
      EXPECT_NEAR(z, wanted, 1e-9);
      roofs += b == kNoBuilding ? 0 : 1;
    }
  EXPECT_GT(roofs, 0);
  const CityMesh tets = mesh_with(city, Cells::kTets, 5);
  EXPECT_LT(5 * facts.cells, 3 * tets.volume_facts.cells);
}

/// 40 % of the terrain within 5 degrees of the steepest that prisms are for.
double ridges(double x, double) { return 10 * std::sin(x / 14); }

/// Rows of houses along the hill, with slots of a metre between them; each is so high at the middle
/// of a side.
testing::SmallCity houses_on(const std::function<double(double, double)>& terrain, double high) {
  testing::SmallCity city = testing::small_city(terrain);
  city.footprints.clear();
  city.roofs.clear();
  for (const int x : {8, 33, 60, 88})
    for (int y = 8; y < 70; y += 13) {
      city.footprints.push_back(testing::rectangle(x, y, x + 12, y + 12));
      city.roofs.push_back(terrain(x + 6, y) + high);
    }
  return city;
}

TEST(Prisms, StandOnHills) {
  for (const auto& terrain : {ridges, testing::hills}) {
    const CityMesh mesh = mesh_with(houses_on(terrain, 9), Cells::kPrisms);
    EXPECT_TRUE(mesh.volume.layers.whole);
    EXPECT_LE(mesh.volume_facts.prisms.max_non_orthogonality_deg, 65);
    EXPECT_LE(mesh.volume_facts.prisms.max_skewness, 3);
    EXPECT_NEAR(mesh.volume_facts.volume / volume_above_floors(mesh.volume, mesh.volume_facts.top),
                1, 1e-9);
  }
}

TEST(Prisms, StandAtBuriedWalls) {
  // Uphill, roofs are metres below the terrain.
  for (const auto& terrain : {ridges, testing::hills}) {
    testing::SmallCity city = testing::small_city(terrain);
    city.footprints.clear();
    city.roofs.clear();
    for (const int x : {8, 50})
      for (const int y : {8, 45}) {
        city.footprints.push_back(testing::rectangle(x, y, x + 36, y + 30));
        city.roofs.push_back(terrain(x + 18, y + 15) + 3);
      }
    MeshCityOptions options;
    options.mesh_size = 4;
    options.cells = Cells::kPrisms;
    const VolumeMeshFacts facts =
        mesh_city(testing::city_model(city), city.dtm, options).volume_facts;
    EXPECT_GT(facts.ground_lowered, 0);
    EXPECT_LE(facts.prisms.max_non_orthogonality_deg, 60.5);
    EXPECT_LE(facts.prisms.max_skewness, 2.8);
  }
}

TEST(Prisms, GiveWayToTetsOnSteepTerrain) {
  const testing::SmallCity steep = testing::small_city([](double x, double) { return x; });
  const CityMesh mesh = mesh_with(steep, Cells::kPrisms);
  EXPECT_FALSE(mesh.volume.layers.whole);
  EXPECT_GT(mesh.volume_facts.prisms.cells, 0);
  EXPECT_GT(mesh.volume_facts.cells, mesh.volume_facts.prisms.cells);
  EXPECT_EQ(std::count_if(mesh.warnings.begin(), mesh.warnings.end(),
                          [](const Warning& w) { return w.code == "too_steep_for_prisms"; }),
            1);
}

TEST(Prisms, CutBackPits) {
  const testing::SmallCity pit = testing::small_city([](double x, double y) {
    return -9 * std::clamp((8 - std::max(std::abs(x - 62), std::abs(y - 40))) / 3, 0.0, 1.0);
  });
  const CityMesh kept = mesh_with(pit, Cells::kPrisms, 5, 90),
                 cut = mesh_with(pit, Cells::kPrisms, 5);
  EXPECT_GT(kept.volume_facts.prisms.max_non_orthogonality_deg, 60);
  EXPECT_TRUE(kept.volume_facts.feet_cut_back.empty());
  const PrismQuality& prisms = cut.volume_facts.prisms;
  EXPECT_LT(prisms.max_non_orthogonality_deg, 60);
  EXPECT_LT(prisms.max_skewness, 2);
  EXPECT_FALSE(cut.volume_facts.feet_cut_back.empty());
  EXPECT_EQ(cut.volume_facts.ground_lowered,
            static_cast<std::int64_t>(cut.volume_facts.feet_cut_back.size()));
  EXPECT_GT(cut.volume_facts.volume, kept.volume_facts.volume);
}

TEST(Prisms, AreNoTallerThanTheFlattestTriangleAllows) {
  // Slots of a metre between high buildings.
  testing::SmallCity city = testing::small_city([](double, double) { return 2.0; });
  city.footprints = {testing::rectangle(40, 30, 60, 45), testing::rectangle(60.5, 30, 80, 45)};
  city.roofs = {14, 22};
  const PrismQuality prisms = mesh_with(city, Cells::kPrisms).volume_facts.prisms;
  EXPECT_GT(prisms.cells, 0);
  EXPECT_LT(prisms.max_aspect_ratio, 60);
}

/// Layers that grow fast are higher than walls, beside which the prisms above them slant.
TEST(Prisms, ShearedAtWallsAreNotBlamedOnTheGround) {
  MeshCityOptions options;
  options.cells = Cells::kPrisms;
  options.boundary_layers = {5, 0.5, 2.5};
  const testing::SmallCity level = testing::small_city([](double, double) { return 2.0; });
  const CityMesh mesh = mesh_city(testing::city_model(level), level.dtm, options);
  ASSERT_GT(mesh.volume_facts.prisms.above_70, 0);
  std::string told;
  for (const Warning& warning : mesh.warnings)
    if (warning.code == "prisms_sheared") told = warning.message;
  EXPECT_NE(told.find("on steep ground or at walls"), std::string::npos) << told;
  options.boundary_layers.growth = 1.2;
  EXPECT_EQ(mesh_city(testing::city_model(level), level.dtm, options).volume_facts.prisms.above_70,
            0);
}

TEST(Prisms, NeedAFlatTop) {
  MeshCityOptions options;
  options.cells = Cells::kPrisms;
  options.top = Top::kFree;
  const testing::SmallCity city = testing::small_city(gentle);
  EXPECT_THROW(mesh_city(testing::city_model(city), city.dtm, options), Error);
}

TEST(Prisms, LayersHigherThanHalfTheDomainAreRefused) {
  MeshCityOptions options;
  options.boundary_layers = {10, 2, 1.2};
  options.domain_height = 60;
  const testing::SmallCity city = testing::small_city(gentle);
  EXPECT_THROW(mesh_city(testing::city_model(city), city.dtm, options), Error);
}

TEST(Prisms, BelowTetsKeepTheFloorOfQuality) {
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    const testing::SmallCity city = testing::small_city(terrain);
    const CityMesh mesh = mesh_with(city, Cells::kTets, 5);
    EXPECT_TRUE(mesh.surface_facts.closed && mesh.surface_facts.manifold);
    EXPECT_GE(mesh.volume_facts.dihedral_min, 8);
    EXPECT_LE(mesh.volume_facts.dihedral_max, 160);
    EXPECT_GT(mesh.volume_facts.prisms.cells, 0);
  }
}

}  // namespace
}  // namespace tetropolis
