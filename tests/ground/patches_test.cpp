#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "ground/construct.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

// What makes refining patch by patch worth it: consecutive numbers, few thousand, near each other.
TEST(Patches, AreSmallTogetherAndLinkedAsBefore) {
  std::mt19937 random(testing::test_seed());
  const auto real = [&] { return static_cast<double>(random()) * 0x1p-32; };
  PlanarGraph graph;
  for (int i = 0; i < 60'000; ++i) graph.points.push_back({1000 * real(), 1000 * real()});
  Construction construction = construct(graph, true);
  TriMesh& mesh = construction.mesh;
  const auto inside =
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [](const TriMesh::Triangle& x) {
        return x.v[0] != TriMesh::kDead && x.region != kOutsideRegion;
      });
  const std::vector<std::int32_t> ends = carve_into_patches(mesh);
  ASSERT_EQ(static_cast<std::ptrdiff_t>(mesh.triangles.size()), inside);
  ASSERT_GE(ends.size(), 16U);
  EXPECT_TRUE(std::is_sorted(ends.begin(), ends.end()));
  EXPECT_EQ(static_cast<std::ptrdiff_t>(ends.back()), inside);
  double boxes = 0;
  std::int32_t first = 0;
  for (const std::int32_t end : ends) {
    EXPECT_LT(end - first, 5000);
    Bounds2 box = Bounds2::nothing();
    for (std::int32_t t = first; t < end; ++t) box.extend(mesh.point(mesh.tri(t).v[0]));
    boxes += box.width() * box.height();
    first = end;
  }
  EXPECT_LT(boxes, 1000 * 1000);
  double sum = 0;
  for (std::int32_t t = 0; t < first; ++t) {
    const TriMesh::Triangle& x = mesh.tri(t);
    sum += signed_area({mesh.point(x.v[0]), mesh.point(x.v[1]), mesh.point(x.v[2])});
    for (std::int32_t i = 0; i < 3; ++i) {
      const std::int32_t he = 4 * t + i;
      if (x.n[i] >= 0) {
        EXPECT_EQ(mesh.link(x.n[i]), he);
        EXPECT_EQ(mesh.origin(x.n[i]), mesh.target(he));
      } else {
        const TriMesh::Subsegment& s = mesh.sub(~x.n[i]);
        EXPECT_TRUE(s.side[0] == he || s.side[1] == he);
      }
    }
  }
  EXPECT_NEAR(sum, 1000 * 1000, 5000) << "the hull is nearly the square";
}

}  // namespace
}  // namespace tetropolis
