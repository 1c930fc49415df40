#include "volume/layers/improve_prisms.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include <gtest/gtest.h>

#include "tetropolis/volume/quality/prism_quality.h"

#include "support/prism_city.h"

namespace tetropolis {
namespace {

double slope(double x, double) { return 0.7 * x; }

TEST(ImprovePrisms, FacesGetBetterAndFloorsStay) {
  testing::MeshedCity city = testing::city_of_prisms(testing::small_city(slope), 6, {5, 0.5, 1.2});
  const ColumnMesh before = city.mesh;
  const PrismQuality was = measure_prisms(before, 0.5);
  const PrismAims aims;
  ASSERT_FALSE(is_within(was, aims));
  const std::int64_t moved = improve_prisms(city.mesh, aims);
  require_valid(city.mesh);
  const PrismQuality is = measure_prisms(city.mesh, 0.5);
  EXPECT_LT(is.max_non_orthogonality_deg, was.max_non_orthogonality_deg - 1);
  EXPECT_LE(is.max_skewness, was.max_skewness);
  EXPECT_LE(is.above_70, was.above_70);
  EXPECT_NEAR(is.volume / was.volume, 1, 1e-12);
  EXPECT_EQ(city.mesh.layers.z, before.layers.z);
  std::int64_t changed = 0;
  for (const VertexIndex v : before.ground.vertices.indices()) {
    bool any = false;
    const std::span<const std::int32_t> floors = before.floors_at(v);
    for (const NodeIndex n : before.nodes(v)) {
      const bool differs = city.mesh.z[n] != before.z[n];
      any |= differs;
      if (std::find(floors.begin(), floors.end(), n - before.first[v]) != floors.end() ||
          n == before.top(v)) {
        EXPECT_FALSE(differs);
      }
      if (n == before.top(v)) continue;
      EXPECT_GE(city.mesh.z[n + 1] - city.mesh.z[n], 0.39 * (before.z[n + 1] - before.z[n]));
    }
    changed += any ? 1 : 0;
  }
  EXPECT_EQ(moved, changed);
}

TEST(ImprovePrisms, LeavesWhatIsGood) {
  testing::MeshedCity city = testing::city_of_prisms(
      testing::small_city([](double, double) { return 1.0; }), 8, {5, 0.5, 1.2});
  const ColumnMesh before = city.mesh;
  EXPECT_EQ(improve_prisms(city.mesh, {85, 50}), 0);
  EXPECT_EQ(city.mesh.z, before.z);
}

}  // namespace
}  // namespace tetropolis
