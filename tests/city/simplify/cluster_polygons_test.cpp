// Clusters of near polygons against all pairs.
#include "city/simplify/cluster_polygons.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_checks.h"
#include "city/grid_geometry.h"
#include "core/sort_once.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::clockwise_box;
using testing::random_star;
using testing::turned;

bool are_near(const Polygon& p, const Polygon& q, double distance) {
  bool near = contains(p, q.outer[0]) || contains(q, p.outer[0]);
  for_each_edge(p, [&](Point2 a, Point2 b) {
    for_each_edge(q, [&](Point2 c, Point2 d) {
      near = near || grid::segment_distance(a, b, c, d) < distance;
    });
  });
  return near;
}

/// Of all pairs, until nothing changes.
std::vector<std::int32_t> clusters_of_pairs(const std::vector<Polygon>& polygons, double distance) {
  const std::size_t n = polygons.size();
  std::vector<std::int32_t> cluster(n);
  std::iota(cluster.begin(), cluster.end(), 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      if (cluster[i] == cluster[j] || !are_near(polygons[i], polygons[j], distance)) continue;
      const auto [low, high] = std::minmax(cluster[i], cluster[j]);
      std::replace(cluster.begin(), cluster.end(), std::int32_t{high}, std::int32_t{low});
    }
  std::vector<std::int32_t> roots = cluster;
  sort_once(roots);
  for (std::int32_t& c : cluster)
    c = static_cast<std::int32_t>(std::lower_bound(roots.begin(), roots.end(), c) - roots.begin());
  return cluster;
}

/// Boxes, stars, rings with things in their holes, and crowds of copies, exact or nearly so.
std::vector<Polygon> random_polygons(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const auto at = [&] { return Point2{300 * unit(random), 300 * unit(random)}; };
  std::vector<Polygon> polygons;
  for (int i = 0; i < 40; ++i) {
    const Point2 p = at();
    const double size = std::pow(10, 1.5 * unit(random));
    switch (static_cast<int>(4 * unit(random))) {
      case 0:
        polygons.push_back(turned(box(p.x, p.y, size, 40 * unit(random) + 0.1), unit(random), p));
        break;
      case 1:
        polygons.push_back(random_star(random, p, size, 12));
        break;
      case 2:
        polygons.push_back({box(p.x, p.y, 20 + size, 20 + size).outer,
                            {clockwise_box(p.x + 2, p.y + 2, 16 + size, 16 + size)}});
        polygons.push_back(box(p.x + 3.5, p.y + 3.5, 2, 2));
        break;
      default: {
        const Polygon one = random_star(random, p, size, 7);
        for (int k = 0; k < 12; ++k) {
          Polygon copy = one;
          if (k > 5)
            for (Point2& q : copy.outer) q.x += 2 * unit(random);
          polygons.push_back(copy);
        }
      }
    }
  }
  std::shuffle(polygons.begin(), polygons.end(), random);
  for (Polygon& polygon : polygons) polygon = grid::to_steps(polygon);
  return polygons;
}

TEST(ClusterPolygons, AreThoseOfAllPairs) {
  std::mt19937 random(testing::test_seed());
  for (int round = 0; round < 30; ++round) {
    SCOPED_TRACE(round);
    const std::vector<Polygon> polygons = random_polygons(random);
    for (const double metres : {0.01, 1.0, 5.0}) {
      const double distance = metres * grid::kSteps;
      EXPECT_EQ(cluster_polygons(polygons, distance), clusters_of_pairs(polygons, distance));
    }
  }
}

TEST(ClusterPolygons, OneOfManyInsideEachOther) {
  std::vector<Polygon> polygons;
  for (int i = 0; i < 3; ++i) polygons.push_back(grid::to_steps(box(40 + 3 * i, 40, 1, 1)));
  polygons.push_back(grid::to_steps(box(0, 0, 100, 100)));
  polygons.push_back(grid::to_steps(box(200, 0, 10, 10)));
  EXPECT_EQ(cluster_polygons(polygons, grid::kSteps), (std::vector<std::int32_t>{0, 0, 0, 0, 1}));
}

}  // namespace
}  // namespace tetropolis
