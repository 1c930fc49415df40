#include "volume/layered/free_top.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/small_city.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

struct Ground {
  GroundMesh mesh;
  EdgeGraph edges;
  double length(std::size_t e) const {
    const auto [a, b] = edges.vertices[e];
    const Point2 p = mesh.vertices[static_cast<std::size_t>(a)];
    const Point2 q = mesh.vertices[static_cast<std::size_t>(b)];
    return std::hypot(q.x - p.x, q.y - p.y);
  }
};

Ground make_ground() {
  const testing::SmallCity city = testing::small_city([](double, double) { return 0.0; });
  Ground ground{mesh_ground(city.footprints, city.domain, {6, 25}), {}};
  ground.edges = build_edge_graph(ground.mesh);
  return ground;
}

/// The least elevations that are not below `top` and whose edges are no steeper, by going over all
/// edges until nothing changes.
std::vector<double> relaxed(const Ground& ground, double slope, std::vector<double> top) {
  for (bool again = true; again;) {
    again = false;
    for (std::size_t e = 0; e < ground.edges.size(); ++e) {
      double& a = top[static_cast<std::size_t>(ground.edges.vertices[e][0])];
      double& b = top[static_cast<std::size_t>(ground.edges.vertices[e][1])];
      const double least = std::max(a, b) - slope * ground.length(e);
      if (least > std::min(a, b) + 1e-9) {
        (a < b ? a : b) = least;
        again = true;
      }
    }
  }
  return top;
}

TEST(FreeTop, IsRaisedAsLittleAsItsSlopeAllows) {
  const Ground ground = make_ground();
  std::mt19937_64 random(testing::test_seed());
  for (const double slope : {0.3, 1.0, 3.0}) {
    SCOPED_TRACE(slope);
    std::vector<double> before(ground.mesh.vertices.size());
    for (double& z : before) z = std::uniform_real_distribution<double>(100, 140)(random);
    std::vector<double> after = before;
    limit_slope(ground.mesh, ground.edges, slope, after);
    const std::vector<double> expected = relaxed(ground, slope, before);
    for (std::size_t v = 0; v < after.size(); ++v) {
      EXPECT_NEAR(after[v], expected[v], 1e-4);  // a micrometre for each edge on the way
    }
    EXPECT_NE(after, before);
  }
}

TEST(FreeTop, GentleOnesStay) {
  const Ground ground = make_ground();
  std::vector<double> top;
  for (const Point2 p : ground.mesh.vertices) top.push_back(100 + 0.9 * p.x - 0.3 * p.y);
  const std::vector<double> before = top;
  limit_slope(ground.mesh, ground.edges, 1, top);
  EXPECT_EQ(top, before);
}

}  // namespace
}  // namespace tetropolis
