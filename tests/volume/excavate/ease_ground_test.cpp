#include "volume/excavate/ease_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/small_city.h"
#include "volume/column/ground_heights.h"

namespace tetropolis {
namespace {

/// A plain with a pit of 7 m, whose sides are 3 m wide, and perhaps another far away.
struct Pits {
  testing::SmallCity city;
  GroundMesh mesh;
  std::vector<double> terrain, eased, lift;
  std::vector<VertexIndex> lowered;

  explicit Pits(bool two, double deep = 7, const PrismBounds& bounds = {}) {
    const auto depth = [](double x, double y, double at_x) {
      const double off = std::max(std::abs(x - at_x) - 5, std::abs(y - 40) - 5);
      return std::clamp(1 - off / 3, 0.0, 1.0);
    };
    city = testing::small_city(
        [&](double x, double y) { return -deep * (depth(x, y, 62) + (two ? depth(x, y, 8) : 0)); });
    mesh = mesh_ground(city.footprints, city.domain, {4, 25});
    terrain = terrain_under(mesh, city.dtm);
    lift.assign(terrain.size(), 3.7);
    eased = terrain;
    for (double& z : eased) z += 3.7;
    lowered = ease_ground(mesh, build_edge_graph(mesh), lift, 0.5, bounds, eased);
    for (double& z : eased) z -= 3.7;
  }

  /// Steepest triangle outside buildings, degrees, from the cosine of its normal.
  double steepest(const std::vector<double>& z) const {
    double least = 1;
    for (const TriangleIndex t : mesh.triangles.indices()) {
      if (mesh.inside_building(t)) continue;
      const auto& v = mesh.triangles[t];
      const Point2 a = mesh.vertices[v[0]], b = mesh.vertices[v[1]], c = mesh.vertices[v[2]];
      const double ab = std::hypot(b.x - a.x, b.y - a.y, z[v[1]] - z[v[0]]);
      const double bc = std::hypot(c.x - b.x, c.y - b.y, z[v[2]] - z[v[1]]);
      const double ca = std::hypot(a.x - c.x, a.y - c.y, z[v[0]] - z[v[2]]);
      const double half = (ab + bc + ca) / 2;  // Heron
      const double area = std::sqrt(half * (half - ab) * (half - bc) * (half - ca));
      const double plan = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
      least = std::min(least, plan / area);
    }
    return std::acos(least) * 180 / std::numbers::pi;
  }
};

TEST(EaseGround, CutsBackThePitAndNothingElse) {
  const Pits pits(false);
  EXPECT_GT(pits.steepest(pits.terrain), 60);
  EXPECT_LE(pits.steepest(pits.eased), 45.001);
  EXPECT_GE(pits.steepest(pits.eased), 43);
  std::vector<VertexIndex> changed;
  for (const VertexIndex v : pits.mesh.vertices.indices()) {
    EXPECT_LE(pits.eased[v], pits.terrain[v] + 1e-9);
    EXPECT_GE(pits.eased[v], -7 - 1e-9);
    if (std::abs(pits.eased[v] - pits.terrain[v]) < 1e-9) continue;
    changed.push_back(v);
    EXPECT_LT(std::hypot(pits.mesh.vertices[v].x - 62, pits.mesh.vertices[v].y - 40), 30);
  }
  EXPECT_FALSE(changed.empty());
  EXPECT_EQ(pits.lowered, changed);
}

/// Upright faces of the lowest prisms, which are half a metre high everywhere: the greatest angle
/// between a face and the line between the centres beside it, degrees, but for faces of more than
/// `flat` where the ground is flat; and the greatest skewness of faces at walls.
struct UprightFaces {
  double non_orthogonal = 0, skewness_at_walls = 0;

  UprightFaces(const Pits& pits, const std::vector<double>& z, double flat) {
    const EdgeGraph edges = build_edge_graph(pits.mesh);
    const auto centre = [&](TriangleIndex t) {
      std::array<double, 3> sum{0, 0, 0.25};
      for (const VertexIndex v : pits.mesh.triangles[t]) {
        sum[0] += pits.mesh.vertices[v].x / 3;
        sum[1] += pits.mesh.vertices[v].y / 3;
        sum[2] += z[v] / 3;
      }
      return sum;
    };
    const auto is_open = [&](TriangleIndex t) {
      return t != kNoTriangle && !pits.mesh.inside_building(t);
    };
    for (const EdgeIndex e : indices<EdgeIndex>(edges.size())) {
      const auto [s, t] = edges.triangles[e];
      if (!is_open(s) && !is_open(t)) continue;
      const auto [a, b] = edges.vertices[e];
      const double ex = pits.mesh.vertices[b].x - pits.mesh.vertices[a].x;
      const double ey = pits.mesh.vertices[b].y - pits.mesh.vertices[a].y;
      const double length = std::hypot(ex, ey);
      const std::array<double, 3> here = centre(is_open(s) ? s : t);
      if (is_open(s) && is_open(t)) {
        const std::array<double, 3> there = centre(t);
        const double dx = there[0] - here[0], dy = there[1] - here[1], dz = there[2] - here[2];
        const double across = std::abs(dx * ey - dy * ex) / length;
        const auto angle = [&](double rise) {
          return std::acos(across / std::hypot(dx, dy, rise)) * 180 / std::numbers::pi;
        };
        if (angle(0) <= flat) non_orthogonal = std::max(non_orthogonal, angle(dz));
        continue;
      }
      // In the plane of the face: along its edge, and up.
      const double mx = (pits.mesh.vertices[a].x + pits.mesh.vertices[b].x) / 2;
      const double my = (pits.mesh.vertices[a].y + pits.mesh.vertices[b].y) / 2;
      const double along = ((mx - here[0]) * ex + (my - here[1]) * ey) / length;
      const double up = (z[a] + z[b]) / 2 + 0.25 - here[2], off = std::hypot(along, up);
      if (!(off > 0)) continue;
      double extent = 0.4 * std::abs((mx - here[0]) * ey - (my - here[1]) * ex) / length;
      for (const double end : {-0.5, 0.5})
        for (const double level : {-0.25, 0.25})
          extent = std::max(
              extent, std::abs(along * end * length + up * (end * (z[b] - z[a]) + level)) / off);
      skewness_at_walls = std::max(skewness_at_walls, off / extent);
    }
  }
};

TEST(EaseGround, BoundsUprightFaces) {
  constexpr double kNone = 1e9;
  const Pits edges(false, 7, {89, 50, kNone}), skewed(false, 7, {89, 89, 1});
  EXPECT_GT(UprightFaces(edges, edges.terrain, 45).non_orthogonal, 60);
  EXPECT_LE(UprightFaces(edges, edges.eased, 45).non_orthogonal, 50.001);
  EXPECT_GT(edges.steepest(edges.eased), 46);
  EXPECT_GT(UprightFaces(skewed, skewed.terrain, 90).skewness_at_walls, 1.2);
  EXPECT_LE(UprightFaces(skewed, skewed.eased, 90).skewness_at_walls, 1.001);
}

TEST(EaseGround, LeavesGentleGround) {
  const Pits pits(true, 0.5);
  EXPECT_TRUE(pits.lowered.empty());
  for (std::size_t v = 0; v < pits.eased.size(); ++v)
    EXPECT_NEAR(pits.eased[v], pits.terrain[v], 1e-12);
}

TEST(EaseGround, KnowsNothingOfFarPlaces) {
  const Pits one(false), two(true);
  ASSERT_EQ(one.mesh.vertices.size(), two.mesh.vertices.size());
  EXPECT_GT(two.lowered.size(), one.lowered.size());
  for (const VertexIndex v : one.mesh.vertices.indices())
    if (one.mesh.vertices[v].x > 40) {
      EXPECT_EQ(one.eased[v], two.eased[v]);
    }
}

}  // namespace
}  // namespace tetropolis
