#include "volume/layered/monotone.h"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

/// Random heights between fixed ones that rise; some columns have a roof, some begin at one.
LayeredMesh tangled_columns(std::mt19937& random) {
  LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 60, 60}, {10, 25}), 7, 0, 70);
  std::uniform_real_distribution<double> height(-200, 200), rise(0.5, 40);
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    for (std::size_t k = 0; k < mesh.stride(); ++k) mesh.column(v)[k] = height(random);
    const int kind = static_cast<int>(random() % 3);
    const auto roof = static_cast<std::int32_t>(1 + random() % 6);
    if (kind > 0) mesh.roof_layer[v] = roof;
    if (kind == 2) mesh.first_node[v] = roof;
    double z = mesh.column(v)[mesh.first_node[v]] = height(random);
    if (kind == 1) z = mesh.column(v)[roof] = z + rise(random);
    mesh.column(v)[mesh.layers] = z + rise(random);
  }
  return mesh;
}

TEST(Monotone, LiftsEveryColumnAndKeepsFixedHeightsExactly) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int trial = 0; trial < 200; ++trial) {
    LayeredMesh mesh = tangled_columns(random);
    const LayeredMesh before = mesh;
    const double share = 0.05 + 0.8 * static_cast<double>(random() % 100) / 100;
    const MonotoneReport report = make_monotone(mesh, {share, true, 10});
    double least = 1e300;
    std::int64_t moved = 0;
    for (const VertexIndex v : mesh.ground.vertices.indices()) {
      const double* z = mesh.column(v);
      const double* old = before.column(v);
      const std::int32_t first = mesh.first_node[v], top = mesh.layers;
      ASSERT_EQ(z[first], old[first]);
      ASSERT_EQ(z[top], old[top]);
      const std::int32_t roof = mesh.roof_layer[v] == kNoRoof ? first : mesh.roof_layer[v];
      ASSERT_EQ(z[roof], old[roof]);
      for (std::int32_t k = 0; k < first; ++k) ASSERT_EQ(z[k], old[k]);
      for (std::int32_t k = first; k < top; ++k) {
        const std::int32_t low = k < roof ? first : roof, high = k < roof ? roof : top;
        ASSERT_GE(z[k + 1] - z[k], share * (z[high] - z[low]) / (high - low) * (1 - 1e-9));
        least = std::min(least, z[k + 1] - z[k]);
        moved += z[k] != old[k];
      }
    }
    EXPECT_EQ(report.min_gap, least);
    EXPECT_GE(report.moved, moved);
  }
}

TEST(Monotone, LeavesGoodColumnsAlone) {
  LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 60, 60}, {10, 25}), 7, 0, 70);
  const auto before = mesh.z;
  const MonotoneReport report = make_monotone(mesh, {0.25, true, 10});
  EXPECT_EQ(report.moved, 0);
  EXPECT_DOUBLE_EQ(report.min_gap, 10);
  EXPECT_EQ(mesh.z, before);
}

TEST(Monotone, LayersOfALadderKeepTheirSharesBelowRoofs) {
  const std::vector<double> ladder{0, 1, 3, 7, 15, 31, 63};
  LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 60, 60}, {10, 25}), ladder);
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    mesh.roof_layer[v] = v.value() % 2 == 0 ? 4 : kNoRoof;
    for (std::int32_t k = 1; k < 4; ++k) mesh.column(v)[k] = 40;  // above the roof at 15 m
    for (std::int32_t k = 5; k < 6; ++k) mesh.column(v)[k] = 62.9;
  }
  make_monotone(mesh, {0.25, true, 10});
  for (const VertexIndex v : mesh.ground.vertices.indices())
    for (std::int32_t k = 0; k < 6; ++k) {
      const double share = mesh.roof_layer[v] == 4 && k < 4 ? 0.9 : 0.25;
      const auto i = static_cast<std::size_t>(k);
      EXPECT_GE(mesh.column(v)[k + 1] - mesh.column(v)[k],
                share * (ladder[i + 1] - ladder[i]) - 1e-9);
    }
}

TEST(Monotone, FreeTopMayMove) {
  LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 60, 60}, {10, 25}), 4, 0, 40);
  for (const VertexIndex v : mesh.ground.vertices.indices()) mesh.column(v)[4] = -5;
  const MonotoneReport report = make_monotone(mesh, {0.25, false, 10});
  EXPECT_EQ(report.min_gap, 2.5);
  for (const VertexIndex v : mesh.ground.vertices.indices()) EXPECT_EQ(mesh.column(v)[4], 32.5);
}

TEST(Monotone, RefusesRoofsBelowTheGround) {
  LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 60, 60}, {10, 25}), 7, 0, 70);
  mesh.roof_layer[3] = 2;
  mesh.column(VertexIndex(3))[2] = -1;
  EXPECT_THROW(make_monotone(mesh, {0.25, true, 10}), Error);
}

TEST(Monotone, HeightsThatAreNoNumbersAreRefused) {
  for (const bool fixed_top : {true, false}) {
    LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 60, 60}, {10, 25}), 7, 0, 70);
    for (std::int32_t k = 0; k <= mesh.layers; ++k)
      mesh.column(VertexIndex(3))[k] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(make_monotone(mesh, {0.25, fixed_top, 10}), Error);
  }
}

}  // namespace
}  // namespace tetropolis
