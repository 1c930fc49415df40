#include "ground/size_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/ground/mesh_ground.h"

#include "ground_cases.h"

namespace tetropolis {
namespace {

using testing::lines;
using testing::Random;

constexpr double kFar = 40;

/// By trying everything.
double expected_size(const std::vector<Polygon>& buildings, double mesh_size,
                     const SizeGrading& grading, Point2 p) {
  double size = std::max(grading.far_size, mesh_size);
  const auto grow = [&](const Polygon& area, double from) {
    double nearest = std::numeric_limits<double>::infinity();
    for_each_edge(area, [&](Point2 a, Point2 b) {
      const double t = std::clamp(((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) /
                                      ((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y)),
                                  0.0, 1.0);
      nearest = std::min(nearest, std::hypot(p.x - a.x - t * (b.x - a.x),  //
                                             p.y - a.y - t * (b.y - a.y)));
    });
    size = std::min(size, from + (grading.growth - 1) * nearest);
  };
  for (const Polygon& building : buildings) grow(building, mesh_size);
  for (const SizeRegion& region : grading.regions) {
    grow(region.area, region.size);
    if (contains(region.area, p)) size = std::min(size, region.size);
  }
  return size;
}

SizeField field_of(const std::vector<Polygon>& buildings, const Bounds2& box, double mesh_size,
                   const SizeGrading& grading) {
  std::vector<const Polygon*> outlines;
  for (const Polygon& building : buildings) outlines.push_back(&building);
  return graded_sizes(outlines, box, mesh_size, grading);
}

struct Case {
  std::vector<Polygon> buildings;
  SizeGrading grading;
};

Case random_case(Random& random) {
  Case made{testing::random_rectangles(random.integer(0, 40), 400, 1, random), {}};
  made.grading.far_size = kFar;
  made.grading.growth = random.integer(0, 1) == 0 ? 1.2 : 1.05;
  for (int i = random.integer(0, 3); i > 0; --i) {
    Polygon area = testing::random_rectangles(1, 150, 1, random)[0];
    for (Point2& p : area.outer) p = {3 * p.x - 30, 2 * p.y};
    made.grading.regions.push_back({area, random.real(2, 20)});
  }
  return made;
}

TEST(SizeField, IsWhatTryingAllSourcesGives) {
  Random random(61);
  const Bounds2 box{-200, -100, 700, 500};
  for (int i = 0; i < 30; ++i) {
    const Case city = random_case(random);
    const SizeField field = field_of(city.buildings, box, 4, city.grading);
    for (int k = 0; k < 500; ++k) {
      const Point2 p{random.real(box.xmin, box.xmax), random.real(box.ymin, box.ymax)};
      const Point2 q{std::clamp(p.x + random.real(-9, 9), box.xmin, box.xmax),
                     std::clamp(p.y + random.real(-9, 9), box.ymin, box.ymax)};
      ASSERT_NEAR(field(p), expected_size(city.buildings, 4, city.grading, p), 1e-9)
          << "case " << i << ", seed " << testing::test_seed();
      ASSERT_LE(std::abs(field(p) - field(q)),
                (city.grading.growth - 1) * std::hypot(p.x - q.x, p.y - q.y) + 1e-9);
    }
    double area = 0, elements = 0, sampled = 0;
    for (const auto& [size, covered] : field.sizes()) {
      area += covered;
      elements += covered / (size * size);
    }
    EXPECT_NEAR(area, 900 * 600, 1e-3);
    for (int x = 0; x < 450; ++x)
      for (int y = 0; y < 300; ++y)
        sampled += 4 / std::pow(field({box.xmin + 2 * x + 1, box.ymin + 2 * y + 1}), 2);
    EXPECT_NEAR(elements / sampled, 1, 0.15);
  }
}

TEST(SizeField, KnowsTheHullOfAllBuildings) {
  const std::vector<Polygon> corners = {rectangle({0, 0, 2, 2}), rectangle({200, 0, 202, 2}),
                                        rectangle({100, 200, 102, 202})};
  SizeGrading grading;
  grading.far_size = 60;
  const Bounds2 box{-500, -500, 700, 700};
  const Point2 middle{100, 90}, far{-480, 650};
  EXPECT_GT(field_of(corners, box, 2, grading)(middle), 20);
  grading.ground_size = 12;
  const SizeField field = field_of(corners, box, 2, grading);
  EXPECT_EQ(field(middle), 12);
  EXPECT_EQ(field(far), 60);
  EXPECT_NEAR(field({100, -10}), 14, 1e-9);  // ten below the hull
}

TEST(SizeField, BoundsTheEdgesOfTheMesh) {
  Random random(62);
  const Bounds2 domain{-200, -100, 700, 500};
  for (int i = 0; i < 6; ++i) {
    const Case city = random_case(random);
    GroundMeshOptions options{4, 25};
    options.grading = city.grading;
    const GroundMesh mesh = mesh_ground(city.buildings, domain, options);
    EXPECT_EQ(lines(validate(mesh, city.buildings, domain, options)), "")
        << "case " << i << ", seed " << testing::test_seed();
    double longest = 0;
    for (const TriangleIndex t : mesh.triangles.indices())
      for (std::size_t k = 0; k < 3; ++k) {
        const Point2 p = mesh.vertices[mesh.triangles[t][k]];
        const Point2 q = mesh.vertices[mesh.triangles[t][(k + 1) % 3]];
        const double length = std::hypot(p.x - q.x, p.y - q.y);
        double bound =
            expected_size(city.buildings, 4, city.grading, {0.5 * (p.x + q.x), 0.5 * (p.y + q.y)});
        if (mesh.inside_building(t)) bound = std::min(bound, 4.0);
        ASSERT_LE(length, bound * (1 + 1e-9)) << "case " << i;
        longest = std::max(longest, length);
      }
    EXPECT_GT(longest, 8);
    if (!city.grading.regions.empty()) continue;  // which may be finer
    GroundMeshOptions uniform{4, 25};
    EXPECT_LT(mesh.triangles.size(), mesh_ground(city.buildings, domain, uniform).triangles.size());
  }
}

TEST(SizeField, SizesOutOfRange) {
  const std::vector<Polygon> city = {rectangle({10, 10, 20, 20})};
  const auto message = [&](const SizeGrading& grading) {
    GroundMeshOptions options{10, 25};
    options.grading = grading;
    try {
      mesh_ground(city, {0, 0, 100, 100}, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}), "");
  EXPECT_NE(message({.far_size = 5}).find("far_size 5 is below mesh_size 10"), std::string::npos);
  EXPECT_NE(message({.far_size = 40, .growth = 1}).find("size_growth"), std::string::npos);
  EXPECT_NE(message({.regions = {{city[0], 0}}}).find("refine"), std::string::npos);
}

}  // namespace
}  // namespace tetropolis
