// Water, roads and vegetation as lines of the ground mesh, against brute force.
#include "tetropolis/ground/surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/ground/mesh_ground.h"

#include "city/roofs/divide_ground.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr double kClearance = 1;
constexpr std::int32_t kOpen = SurfaceLine::kOpenGround;

Polygon box(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}};
}

struct Town {
  Domain domain{0, 0, 200, 160};
  std::vector<Polygon> footprints;
  std::vector<SurfaceArea> areas;
};

/// Blocks with a canal through them and out of the domain, streets, and parks of random outlines
/// that overlap all that.
Town town(unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  const auto on_grid = [](double x) { return std::round(x * 1e4) / 1e4; };
  Town town;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 5; ++i) {
      const double x = on_grid(40 * i + draw(4, 12)), y = on_grid(40 * j + draw(4, 12));
      town.footprints.push_back(box(x, y, on_grid(x + draw(8, 22)), on_grid(y + draw(8, 22))));
      if (i == 2) {
        Polygon& block = town.footprints.back();
        for (Point2& p : block.outer) {
          const double u = p.x - x, v = p.y - y;
          p = {on_grid(x + 0.8 * u - 0.3 * v + 6), on_grid(y + 0.3 * u + 0.8 * v)};
        }
      }
    }
  Polygon canal;
  for (double x = -20; x <= 220; x += 7) canal.outer.push_back({x, 76 + 5 * std::sin(x / 15)});
  for (double x = 220; x >= -20; x -= 7)
    canal.outer.push_back({x, 84 + 5 * std::sin(x / 15) + draw(-0.3, 0.3)});
  town.areas.push_back({SurfaceKind::kWater, canal});
  for (const double x : {37.0, 118.5})
    town.areas.push_back({SurfaceKind::kRoad, box(x, -5, x + 6, 170)});
  town.areas.push_back({SurfaceKind::kRoad, box(-5, 36.6, 205, 41)});
  for (int k = 0; k < 6; ++k) {
    const Point2 at{draw(0, 200), draw(0, 160)};
    Polygon park;
    for (int i = 0; i < 23; ++i) {
      const double angle = 0.273 * i, radius = draw(6, 24);
      park.outer.push_back({at.x + radius * std::cos(angle), at.y + radius * std::sin(angle)});
    }
    town.areas.push_back({SurfaceKind::kVegetation, park});
  }
  return town;
}

/// What is at a place, by the line that a ray to the right meets first.
std::int32_t area_at(const Surfaces& surfaces, Point2 p) {
  double nearest = std::numeric_limits<double>::infinity();
  std::int32_t found = SurfaceLine::kBeyond;
  for (const SurfaceLine& line : surfaces.lines) {
    if ((line.from.y > p.y) == (line.to.y > p.y)) continue;
    const double x =
        line.from.x + (line.to.x - line.from.x) * (p.y - line.from.y) / (line.to.y - line.from.y);
    if (x < p.x || x >= nearest) continue;
    nearest = x;
    found = line.from.y < line.to.y ? line.left : line.right;
  }
  return found;
}

/// The kind that the input gives a place, as a number like those of area_at by kind.
int kind_given(const Town& town, Point2 p) {
  for (const Polygon& footprint : town.footprints)
    if (contains(footprint, p)) return SurfaceLine::kBeyond;
  int kind = kOpen;
  for (const SurfaceArea& area : town.areas)
    if (contains(area.area, p))
      kind =
          kind == kOpen ? static_cast<int>(area.kind) : std::min(kind, static_cast<int>(area.kind));
  return kind;
}

int kind_of(const Surfaces& surfaces, std::int32_t area) {
  return area < 0 ? area : static_cast<int>(surfaces.kinds[static_cast<std::size_t>(area)]);
}

class SurfacesOfTowns : public ::testing::TestWithParam<unsigned> {
 protected:
  SurfacesOfTowns() : given(town(GetParam())) {
    surfaces = divide_ground(given.areas, given.footprints, given.domain, kClearance);
    for (const Polygon& footprint : given.footprints)
      for (const Point2 p : footprint.outer) corners.insert({p.x, p.y});
    for (const Point2 p : given.domain.outline().outer) corners.insert({p.x, p.y});
  }
  bool is_corner(Point2 p) const { return corners.contains({p.x, p.y}); }

  Town given;
  Surfaces surfaces;
  std::set<std::pair<double, double>> corners;
};

TEST_P(SurfacesOfTowns, KeepTheClearance) {
  std::set<std::pair<double, double>> ends;
  for (const SurfaceLine& line : surfaces.lines)
    for (const Point2 p : {line.from, line.to}) ends.insert({p.x, p.y});
  ASSERT_GT(ends.size(), corners.size() + 50);
  for (const auto& corner : corners) EXPECT_TRUE(ends.contains(corner));
  for (const SurfaceLine& line : surfaces.lines) {
    ASSERT_NE(line.left, line.right);
    const bool is_outline = std::min(line.left, line.right) == SurfaceLine::kBeyond;
    const bool is_own = is_outline && is_corner(line.from) && is_corner(line.to);
    if (!is_own) {
      EXPECT_GE(std::hypot(line.to.x - line.from.x, line.to.y - line.from.y), kClearance);
    }
    for (const auto& [x, y] : ends) {
      const Point2 p{x, y};
      if (p == line.from || p == line.to || (is_own && is_corner(p))) continue;
      const double d = distance_to_segment(p, line.from, line.to);
      if (d >= kClearance) continue;
      // Near to an end that it has a line to: that is an angle, not a gap.
      const bool is_joined =
          std::any_of(surfaces.lines.begin(), surfaces.lines.end(), [&](const SurfaceLine& other) {
            const auto joins = [&](Point2 q) {
              return (other.from == p && other.to == q) || (other.to == p && other.from == q);
            };
            return joins(line.from) || joins(line.to);
          });
      EXPECT_TRUE(is_joined) << x << " " << y << " is " << d << " from a line";
    }
  }
}

TEST_P(SurfacesOfTowns, AreWhereTheyWereGiven) {
  std::array<double, 3> wrong{};
  // Off the grid that corners are on, so that no point is on a line.
  for (double y = 0.371234567; y < 160; y += 0.5)
    for (double x = 0.412345678; x < 200; x += 0.5) {
      const Point2 p{x, y};
      const int is = kind_of(surfaces, area_at(surfaces, p)), was = kind_given(given, p);
      ASSERT_EQ(is == SurfaceLine::kBeyond, was == SurfaceLine::kBeyond) << x << " " << y;
      if (is != was)
        for (const int kind : {is, was})
          if (kind >= 0) wrong[static_cast<std::size_t>(kind)] += 0.25;
    }
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_GT(surfaces.area_given[k], 100);
    EXPECT_LT(wrong[k], 0.1 * surfaces.area_given[k]) << kSurfaceKindNames[k];
    EXPECT_NEAR(surfaces.area_meshed[k], surfaces.area_given[k], 0.1 * surfaces.area_given[k]);
  }
}

TEST_P(SurfacesOfTowns, AreRegionsOfTheGroundMesh) {
  GroundMeshOptions options{8, 25};
  options.surfaces = &surfaces;
  const GroundMesh mesh = mesh_ground(given.footprints, given.domain, options);
  ASSERT_EQ(mesh.regions.size(), given.footprints.size() + 1 + surfaces.kinds.size());
  double total = 0;
  for (const TriangleIndex t : mesh.triangles.indices()) {
    std::vector<Point2> p;
    for (const VertexIndex v : mesh.triangles[t]) p.push_back(mesh.vertices[v]);
    const Point2 centre{(p[0].x + p[1].x + p[2].x) / 3, (p[0].y + p[1].y + p[2].y) / 3};
    const std::int32_t area = area_at(surfaces, centre);
    const Region& region = mesh.region_of(t);
    EXPECT_EQ(region.is_building(), area == SurfaceLine::kBeyond);
    if (area == SurfaceLine::kBeyond) continue;
    EXPECT_EQ(mesh.region[t].value(), static_cast<int>(given.footprints.size()) + 1 + area);
    EXPECT_EQ(
        mesh.patches.of(region.floor).name,
        area < 0 ? "ground" : kSurfaceKindNames[static_cast<std::size_t>(kind_of(surfaces, area))]);
    total += signed_area(p);
  }
  double built = 0;
  for (const Polygon& footprint : given.footprints) built += area(footprint);
  EXPECT_NEAR(total, 200 * 160 - built, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Towns, SurfacesOfTowns,
                         ::testing::Values(1U, 2U, 511184U, testing::test_seed(),
                                           testing::test_seed() + 1));

TEST(Surfaces, WithoutAreasThereIsNothing) {
  const Domain domain{0, 0, 50, 50};
  EXPECT_TRUE(divide_ground({}, {}, domain, 1).lines.empty());
  const std::vector<SurfaceArea> elsewhere{{SurfaceKind::kWater, box(100, 100, 120, 120)}};
  EXPECT_TRUE(divide_ground(elsewhere, {}, domain, 1).kinds.empty());
}

TEST(Surfaces, OneThatIsAllTheDomain) {
  const Domain domain{0, 0, 50, 50};
  const std::vector<SurfaceArea> sea{{SurfaceKind::kWater, box(-10, -10, 60, 60)}};
  const std::vector<Polygon> island{box(20, 20, 30, 30)};
  const Surfaces surfaces = divide_ground(sea, island, domain, 1);
  ASSERT_EQ(surfaces.kinds, std::vector<SurfaceKind>{SurfaceKind::kWater});
  EXPECT_NEAR(surfaces.area_meshed[0], 2400, 1e-6);
  EXPECT_EQ(surfaces.lines.size(), 8U);
}

}  // namespace
}  // namespace tetropolis
