#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "ground/construct.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

// What makes refining in this order worth it: consecutive numbers are near each other.
TEST(CarveAlongCurve, NumbersWhatIsNearTogetherAndLinksAsBefore) {
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
  carve_along_curve(mesh);
  ASSERT_EQ(static_cast<std::ptrdiff_t>(mesh.triangles.size()), inside);
  constexpr std::int32_t kChunk = 4096;
  const auto count = static_cast<std::int32_t>(inside);
  double boxes = 0;
  for (std::int32_t first = 0; first < count; first += kChunk) {
    Bounds2 box = Bounds2::nothing();
    for (std::int32_t t = first; t < std::min(first + kChunk, count); ++t)
      box.extend(mesh.point(mesh.tri(t).v[0]));
    boxes += box.width() * box.height();
  }
  EXPECT_LT(boxes, 3 * 1000 * 1000) << "of " << count / kChunk << " chunks";
  double sum = 0;
  for (std::int32_t t = 0; t < count; ++t) {
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
