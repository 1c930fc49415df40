// What happens here does not depend on a far place (guarantee 9 of the plan).
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tetropolis/pipeline/mesh_city.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr double kSize = 1200, kPitch = 100;

/// Boxes about the nodes of a grid, turned and as large as the seed has them.
CityModel random_boxes() {
  std::mt19937 random(testing::test_seed());
  const auto real = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) * 0x1p-32;
  };
  CityModel city;
  city.domain = Domain(Bounds2{0, 0, kSize, kSize});
  for (double x = kPitch / 2; x < kSize; x += kPitch)
    for (double y = kPitch / 2; y < kSize; y += kPitch) {
      const double a = real(8, 20), b = real(8, 20), turn = real(0, 3);
      const Point2 centre{x + real(-15, 15), y + real(-15, 15)};
      Building building;
      building.id = "b" + std::to_string(city.buildings.size());
      for (const auto& [u, v] :
           std::array<std::pair<double, double>, 4>{{{-a, -b}, {a, -b}, {a, b}, {-a, b}}})
        building.footprint.outer.push_back({centre.x + u * std::cos(turn) - v * std::sin(turn),
                                            centre.y + u * std::sin(turn) + v * std::cos(turn)});
      building.h_ground = 0;
      building.h_roof = real(5, 25);
      city.buildings.push_back(building);
    }
  return city;
}

/// All nodes further than `far` from the origin.
std::set<std::array<double, 3>> nodes_beyond(const ColumnMesh& mesh, double far) {
  std::set<std::array<double, 3>> nodes;
  const auto add = [&](VertexIndex v, double z) {
    const Point2 p = mesh.ground.vertices[v];
    if (std::hypot(p.x, p.y) > far) nodes.insert({p.x, p.y, z});
  };
  for (const VertexIndex v : mesh.ground.vertices.indices())
    for (const NodeIndex n : mesh.nodes(v)) add(v, mesh.z[n]);
  for (std::size_t i = 0; i < mesh.upper.nodes(); ++i) add(mesh.upper.vertex[i], mesh.upper.z[i]);
  return nodes;
}

TEST(Locality, AHouseInTheCornerChangesNothingFarAway) {
  constexpr double kFar = 600;
  const CityModel city = random_boxes();
  CityModel without = city;
  without.buildings.erase(without.buildings.begin());
  Raster terrain;
  terrain.nx = terrain.ny = 2;
  terrain.step = kSize;
  terrain.values.assign(4, 0.0);
  for (const double far_size : {0.0, 40.0}) {
    MeshCityOptions options;
    options.grading.far_size = far_size;
    const auto mesh_of = [&](const CityModel& model) {
      return nodes_beyond(mesh_city(model, terrain, options).volume, kFar);
    };
    const auto all = mesh_of(city), others = mesh_of(without);
    EXPECT_GT(all.size(), 10'000U);
    const auto gone = std::count_if(all.begin(), all.end(),
                                    [&](const auto& node) { return !others.contains(node); });
    EXPECT_EQ(gone, 0) << far_size;
    EXPECT_EQ(all.size(), others.size()) << far_size;
  }
}

}  // namespace
}  // namespace tetropolis
