#include "volume/layered/layered_mesh.h"

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/small_city.h"

namespace tetropolis {
namespace {

TEST(LayeredMesh, DividesTheHeightEvenly) {
  const LayeredMesh mesh = make_layers(mesh_ground({}, {0, 0, 10, 10}, {5, 25}), 4, -10, 30);
  for (const VertexIndex v : mesh.ground.vertices.indices())
    for (std::int32_t k = 0; k <= 4; ++k) EXPECT_EQ(mesh.column(v)[k], -10 + 10 * k);
}

TEST(LayeredMesh, RefusesADomainWithoutHeight) {
  const GroundMesh ground = mesh_ground({}, {0, 0, 10, 10}, {5, 25});
  EXPECT_THROW(make_layers(ground, 0, 0, 10), Error);
  EXPECT_THROW(make_layers(ground, 3, 10, 10), Error);
}

}  // namespace
}  // namespace tetropolis
