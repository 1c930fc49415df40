// Guarantee 3 from the boundary and the footprints: good meshes pass, and each way to break one is
// seen.
#include "check/check_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "tetropolis/ground/mesh_ground.h"

#include "ground/validate.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

const char* const kVertex = "footprint vertices off the roof's outline";
const char* const kOutline = "roof outlines that leave the footprint's edges";

class CheckGround : public ::testing::Test {
 protected:
  void SetUp() override {
    const testing::MeshedCity meshed = testing::meshed(testing::small_city(testing::hills), 12);
    ground = meshed.mesh.ground;
    surface = extract_boundary(meshed.mesh);
    for (std::size_t b = 0; b < meshed.city.footprints.size(); ++b) {
      Building& building = model.buildings.emplace_back();
      building.id = "b" + std::to_string(b);
      building.footprint = meshed.city.footprints[b];
    }
  }

  GroundCheck check(double min_angle_deg = 25) const {
    return check_ground(surface, {0, 0, 0}, model, min_angle_deg);
  }
  std::map<std::string, std::int64_t> violations() const {
    std::map<std::string, std::int64_t> counts;
    for (const Violation& violation : check().violations) counts[violation.what] = violation.count;
    return counts;
  }
  std::array<double, 3>& vertex_at(Point2 p, Patch patch) {
    for (std::size_t f = 0; f < surface.triangles.size(); ++f)
      for (const std::int32_t v : surface.triangles[f]) {
        auto& q = surface.points[static_cast<std::size_t>(v)];
        if (surface.patch[f] == patch && q[0] == p.x && q[1] == p.y) return q;
      }
    ADD_FAILURE() << "no such vertex";
    return surface.points[0];
  }

  GroundMesh ground;
  SurfaceMesh surface;
  CityModel model;
  using Counts = std::map<std::string, std::int64_t>;
};

TEST_F(CheckGround, MeasuresTheGroundMeshInAnyFrame) {
  const AngleStatistics expected = angle_statistics(ground.vertices, ground.triangles);
  model.origin = {319000, 6396000};
  for (const bool absolute : {false, true}) {
    std::array<double, 3> shift{0, 0, 0};
    if (absolute) {
      shift = {-model.origin.x, -model.origin.y, 0};
      for (auto& p : surface.points) p = {p[0] + model.origin.x, p[1] + model.origin.y, p[2]};
    }
    for (const double limit : {25.0, 44.0}) {
      const GroundCheck found = check_ground(surface, shift, model, limit);
      EXPECT_EQ(found.violations.empty(), limit == 25);
      EXPECT_EQ(found.triangles, static_cast<std::int64_t>(ground.triangles.size()));
      EXPECT_NEAR(found.least_angle_deg, expected.min_deg, 1e-6);
      const auto [low, high] = found.least_angle_bounds_deg;
      EXPECT_LE(low, expected.min_deg);
      EXPECT_GE(high, expected.min_deg);
      EXPECT_LT(high - low, 1e-6);
      EXPECT_EQ(found.below == 0, limit == 25);
      EXPECT_LE(found.below_bounds[0], found.below);
      EXPECT_GE(found.below_bounds[1], found.below);
      EXPECT_LE(found.below_bounds[1] - found.below_bounds[0], 1);
    }
  }
}

TEST_F(CheckGround, AnglesAreSmallOnlyAtSharpCorners) {
  testing::SmallCity city = testing::small_city(testing::hills);
  city.footprints[3] = Polygon{{{10, 45}, {30, 45}, {30, 41}}, {}};  // 11.3 degrees
  const testing::MeshedCity sharp = testing::meshed(city, 12);
  surface = extract_boundary(sharp.mesh);
  model.buildings[3].footprint = city.footprints[3];
  const GroundCheck found = check();
  EXPECT_NEAR(found.least_angle_deg, std::atan2(4, 20) * 180 / std::numbers::pi, 1e-6);
  EXPECT_GT(found.below, 0);
  EXPECT_EQ(violations(), Counts{});
  // A vertex of the ground away from walls is moved near to another.
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (surface.patch[f] != Patch::kGround) continue;
    const auto& t = surface.triangles[f];
    const auto& p = surface.points[static_cast<std::size_t>(t[0])];
    auto& q = surface.points[static_cast<std::size_t>(t[1])];
    if (q[0] < 107 || q[0] > 119 || q[1] < 5 || q[1] > 85) continue;
    q[0] += 0.9 * (p[0] - q[0]);
    q[1] += 0.9 * (p[1] - q[1]);
    break;
  }
  const Counts counts = violations();
  ASSERT_EQ(counts.size(), 1U);
  EXPECT_EQ(counts.begin()->first, "angles below the minimum where no input corner is sharper");
}

TEST_F(CheckGround, SeesFootprintVerticesThatTheMeshLacks) {
  model.buildings[0].footprint.outer[1].x += 1e-4;
  EXPECT_EQ(violations(), (Counts{{kVertex, 1}, {kOutline, 1}}));
  model.buildings[0].footprint.outer[1].x -= 1e-4;
  // A vertex more, in the middle of an edge, does not change the length.
  Ring& hole = model.buildings[2].footprint.holes[0];
  const Point2 a = hole[0], b = hole[1];
  hole.insert(hole.begin() + 1, {a.x + 0.317 * (b.x - a.x), a.y + 0.317 * (b.y - a.y)});
  EXPECT_EQ(violations(), (Counts{{kVertex, 1}}));
  hole.erase(hole.begin() + 1);
  EXPECT_EQ(violations(), Counts{});
}

TEST_F(CheckGround, SeesCourtyardsThatAreMissingOnEitherSide) {
  Polygon& footprint = model.buildings[2].footprint;
  const Ring hole = footprint.holes[0];
  footprint.holes.clear();
  EXPECT_EQ(violations(), (Counts{{kOutline, 1}}));
  footprint.holes = {hole, {{72, 22}, {72, 24}, {74, 24}, {74, 22}}};
  EXPECT_EQ(violations(), (Counts{{kVertex, 4}, {kOutline, 1}}));
}

TEST_F(CheckGround, SeesOutlinesThatLeaveTheEdges) {
  // One roof face becomes ground: the outline goes around it.
  const auto roof = static_cast<std::size_t>(
      std::find(surface.patch.begin(), surface.patch.end(), Patch::kRoof) - surface.patch.begin());
  SurfaceMesh whole = surface;
  surface.patch[roof] = Patch::kGround;
  EXPECT_TRUE(violations().contains(kOutline));
  surface = whole;
  // A vertex between two corners is pushed 5 mm into the street.
  bool pushed = false;
  for (std::size_t f = 0; f < surface.triangles.size() && !pushed; ++f)
    for (const std::int32_t v : surface.triangles[f]) {
      auto& p = surface.points[static_cast<std::size_t>(v)];
      if (surface.patch[f] != Patch::kRoof || p[1] != 15 || !(p[0] > 21 && p[0] < 37)) continue;
      p[1] -= 0.005;
      pushed = true;
      break;
    }
  ASSERT_TRUE(pushed);
  EXPECT_EQ(violations(), (Counts{{kOutline, 1}}));
}

TEST_F(CheckGround, SeesBuildingsWithoutRoof) {
  model.buildings.emplace_back();
  model.buildings.back().footprint = testing::rectangle(1, 1, 4, 4);
  EXPECT_EQ(violations(), (Counts{{"buildings without roof faces", 1}}));
  // Roofs of buildings that the model lacks are for check_heights to see.
  model.buildings.resize(3);
  EXPECT_EQ(violations(), Counts{});
}

TEST_F(CheckGround, EndsOnCoordinatesThatAreNotFinite) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const Point2 corner = model.buildings[3].footprint.outer[0];
    auto& p = vertex_at(corner, Patch::kRoof);
    p[0] = value;
    EXPECT_EQ(violations(), (Counts{{kVertex, 1}, {kOutline, 1}}));
    p[0] = corner.x;
    model.buildings[3].footprint.outer[0].y = value;
    EXPECT_EQ(violations(), (Counts{{kVertex, 1}, {kOutline, 1}}));
    model.buildings[3].footprint.outer[0] = corner;
  }
}

}  // namespace
}  // namespace tetropolis
