#include "volume/upper/mend_front.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/small_city.h"
#include "volume/upper/grow_upper.h"
#include "volume/upper/lid.h"

namespace tetropolis {
namespace {

/// Columns up to the lid, in a domain that is wide beside its height.
testing::MeshedCity wide_city() {
  testing::SmallCity city = testing::small_city(testing::hills);
  city.domain = {-400, -400, 500, 500};
  city.dtm = testing::raster_of(city.domain, testing::hills);
  testing::MeshedCity result = testing::meshed(std::move(city), 5);
  lower_tops(result.mesh.ground, result.mesh.edges, result.plan);
  result.mesh =
      divide_columns(std::move(result.mesh.ground), std::move(result.mesh.edges), result.plan);
  place_nodes(result.mesh, result.plan);
  return result;
}

void expect_same(const UpperMesh& a, const UpperMesh& b) {
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.others, b.others);
  EXPECT_EQ(a.over_lid, b.over_lid);
  ASSERT_EQ(a.fans.size(), b.fans.size());
  EXPECT_TRUE(std::equal(
      a.fans.begin(), a.fans.end(), b.fans.begin(), [](const UpperFan& f, const UpperFan& g) {
        return f.node == g.node && f.up == g.up && f.cell == g.cell && f.other == g.other;
      }));
}

TEST(MendFront, IsAsIfAllColumnsHadClimbedAgain) {
  const testing::MeshedCity city = wide_city();
  const ColumnMesh& mesh = city.mesh;
  const double top = city.plan.layers.top;
  std::vector<double> shares(mesh.vertex_count(), 1.0);
  FrontClimb climb(mesh, top, 3);
  FrontPhases phases = climb.to_top(shares);
  for (std::vector<FrontSteps>& tiles : phases)
    for (FrontSteps& tile : tiles) tile.poor.clear();
  // Said to be poor, more than any will be.
  for (const Point2 place : {Point2{-200, -180}, Point2{60, 45}, Point2{300, 310}}) {
    VertexIndex nearest{0};
    const auto distance = [&](VertexIndex v) {
      const Point2 p = mesh.ground.vertices[v];
      return std::hypot(p.x - place.x, p.y - place.y);
    };
    for (const VertexIndex v : mesh.ground.vertices.indices())
      if (distance(v) < distance(nearest)) nearest = v;
    phases.front().front().poor.insert(phases.front().front().poor.end(), 1000, nearest);
    shares[nearest] *= 0.85;
  }
  const FrontPhases expected = FrontClimb(mesh, top, 1).to_top(shares);
  for (const std::vector<FrontSteps>& tiles : expected)
    for (const FrontSteps& tile : tiles) EXPECT_TRUE(tile.poor.empty());
  const UpperMesh before = upper_of(phases, mesh), after = upper_of(expected, mesh);
  EXPECT_NE(before.z, after.z);
  const std::size_t count = phases.size();
  mend_front(mesh, top, climb, phases);
  EXPECT_EQ(phases.size(), count + 1);  // Not all have.
  expect_same(upper_of(std::move(phases), mesh), after);
}

}  // namespace
}  // namespace tetropolis
