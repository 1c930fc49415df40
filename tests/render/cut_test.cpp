#include "render/cut.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/volume/column/boundary.h"

#include "render/split_prisms.h"
#include "render/volume_surface.h"
#include "support/test_data.h"
#include "terraced_city.h"

namespace tetropolis {
namespace {

using testing::TerracedCity;

double area_of(const CutCell& cell) {
  double twice = 0;
  for (int i = 0; i < cell.size; ++i) {
    const Point2 a = cell.corners[static_cast<std::size_t>(i)];
    const Point2 b = cell.corners[static_cast<std::size_t>((i + 1) % cell.size)];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

/// Calls use(length, height of the field) for the stretches of the plane's line.
template <typename Use>
void along_line(const TerracedCity& city, const CutPlane& plane, const Use& use) {
  std::vector<double> stops;
  for (int i = 0; i <= TerracedCity::kWidth; ++i)
    if (plane.along.x != 0) stops.push_back((i - plane.through.x) / plane.along.x);
  for (int j = 0; j <= TerracedCity::kDepth; ++j)
    if (plane.along.y != 0) stops.push_back((j - plane.through.y) / plane.along.y);
  std::sort(stops.begin(), stops.end());
  for (std::size_t s = 0; s + 1 < stops.size(); ++s) {
    const Vec3 p = plane.at({(stops[s] + stops[s + 1]) / 2, 0});
    if (p.x < 0 || p.y < 0 || p.x >= TerracedCity::kWidth || p.y >= TerracedCity::kDepth) continue;
    use(stops[s + 1] - stops[s],
        city.height[static_cast<std::size_t>(p.x)][static_cast<std::size_t>(p.y)]);
  }
}

TEST(Cut, CellsCoverTheSectionLessTheBuildings) {
  std::mt19937 random(testing::test_seed());
  const TerracedCity city = testing::terraced_city(random);
  const SurfaceMesh surface = surface_of(city.mesh);
  std::uniform_real_distribution<double> x(3, 9), y(2, 7);
  for (const double azimuth : {0.0, 90.0, 17.0, 45.0, 130.0, 288.0}) {
    const CutPlane plane = plane_along(azimuth, {x(random), y(random), 0});
    double expected = 0, length = 0;
    along_line(city, plane, [&](double stretch, int height) {
      expected += stretch * (TerracedCity::kTop - height);
      length += stretch;
    });
    double covered = 0;
    std::map<int, int> sizes;
    for (const CutCell& cell : cut_cells(city.mesh, plane)) {
      covered += area_of(cell);
      ++sizes[cell.size];
    }
    EXPECT_NEAR(covered, expected, 1e-9) << azimuth << ", seed " << testing::test_seed();
    EXPECT_GT(sizes[3], 10);
    EXPECT_GT(sizes[4], 10);
    // The profile runs below all of it, once.
    double profile = 0, below = 0;
    for (const CutFace& face : cut_faces(surface, plane)) {
      if (face.kind == PatchKind::kWall) continue;
      const double stretch = std::abs(face.ends[1].x - face.ends[0].x);
      profile += stretch;
      below += stretch * (face.ends[0].y + face.ends[1].y) / 2;
    }
    EXPECT_NEAR(profile, length, 1e-9);
    EXPECT_NEAR(below, length * TerracedCity::kTop - expected, 1e-9);
  }
}

TEST(Cut, PrismsAreCutWhole) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> anywhere(0, 10);
  TetMesh mesh;
  for (int k = 0; k < 200; ++k) {
    std::array<std::int64_t, 6> wedge{};
    std::array<Point2, 3> p;
    for (Point2& corner : p) corner = {anywhere(random), anywhere(random)};
    for (std::size_t i = 0; i < 6; ++i) {
      wedge[i] = std::ssize(mesh.points);
      mesh.points.push_back({p[i % 3].x, p[i % 3].y, anywhere(random) + (i < 3 ? 0 : 20)});
    }
    mesh.wedges.push_back(wedge);
  }
  const CutPlane plane = plane_along(37, {5, 5, 0});
  const std::vector<CutCell> whole = cut_cells(mesh, plane);
  ASSERT_GT(whole.size(), 50);
  double area = 0, area_of_tets = 0;
  for (const CutCell& cell : whole) {
    EXPECT_EQ(cell.size, 4);
    EXPECT_GT(area_of(cell), 0);
    area += area_of(cell);
  }
  for (const CutCell& cell : cut_cells(split_prisms(mesh), plane)) area_of_tets += area_of(cell);
  EXPECT_NEAR(area, area_of_tets, 1e-9 * area);
}

TEST(Cut, RightIsAlongTheLineAndBehindAtItsLeft) {
  const CutPlane plane = plane_along(90, {0, 5, 0});
  EXPECT_EQ(plane.position({7, 5, 0}), 7);
  EXPECT_EQ(plane.distance({7, 8, 0}), 3);
  EXPECT_EQ(plane.at({7, 2}), Vec3(7, 5, 2));
  EXPECT_GT(plane_along(0, {}).distance({-1, 0, 0}), 0);
}

TEST(VolumeSurface, IsGroundRoofsAndWalls) {
  std::mt19937 random(testing::test_seed());
  const TerracedCity city = testing::terraced_city(random);
  const SurfaceMesh surface = surface_of(city.mesh);
  std::map<Patch, double> area;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto p = [&](std::size_t i) {
      return Vec3(surface.points[static_cast<std::size_t>(surface.triangles[f][i])]);
    };
    const Vec3 n = cross(p(1) - p(0), p(2) - p(0));
    area[surface.patch[f]] += std::sqrt(dot(n, n)) / 2;
  }
  double ground = 0, roof = 0, wall = 0;
  const auto height = [&](int i, int j) {
    return city.height[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  };
  for (int i = 0; i < TerracedCity::kWidth; ++i)
    for (int j = 0; j < TerracedCity::kDepth; ++j) {
      (height(i, j) > 0 ? roof : ground) += 1;
      if (i > 0) wall += std::abs(height(i, j) - height(i - 1, j));
      if (j > 0) wall += std::abs(height(i, j) - height(i, j - 1));
    }
  EXPECT_NEAR(area[Patch::kGround], ground, 1e-9);
  EXPECT_NEAR(area[Patch::kRoof], roof, 1e-9);
  EXPECT_NEAR(area[Patch::kWall], wall, 1e-9);
  EXPECT_EQ(area.size(), 3);  // neither top nor sides
}

}  // namespace
}  // namespace tetropolis
