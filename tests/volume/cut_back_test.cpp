#include "tetropolis/volume/cut_back.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/volume/cell_quality.h"
#include "tetropolis/volume/fill_columns.h"
#include "tetropolis/volume/ground_heights.h"
#include "tetropolis/volume/improve_columns.h"

#include "support/small_city.h"

namespace tetropolis {
namespace {

/// Distance of p from a rectangle with sides along the axes.
double distance(const Bounds2& box, Point2 p) {
  const double dx = std::max({box.xmin - p.x, 0.0, p.x - box.xmax});
  const double dy = std::max({box.ymin - p.y, 0.0, p.y - box.ymax});
  return std::hypot(dx, dy);
}

/// Two houses on a plain 20 m above the roof of the first, whose surroundings are dug out; and,
/// from x = 90, a basin below any slope from there.
struct Basin {
  testing::SmallCity city;
  Bounds2 low{30, 30, 45, 45}, high{49, 30, 60, 45};
  GroundMesh mesh;
  std::vector<BuildingIndex> owner;
  std::vector<double> terrain;

  explicit Basin(double size) {
    city.footprints = {testing::rectangle(low.xmin, low.ymin, low.xmax, low.ymax),
                       testing::rectangle(high.xmin, high.ymin, high.xmax, high.ymax)};
    city.roofs = {0, 30};
    city.dtm =
        testing::raster_of(city.domain, [](double x, double) { return x < 90 ? 20.0 : -100.0; });
    mesh = mesh_ground(city.footprints, city.domain, {size, 25});
    owner = vertex_buildings(mesh);
    terrain = terrain_under(mesh, city.dtm);
  }
};

TEST(CutBack, GroundRisesFromTheRoofAsAsked) {
  for (const double slope : {1.0, 1.5, 3.0})
    for (const double size : {3.0, 8.0}) {
      SCOPED_TRACE(::testing::Message() << slope << " " << size);
      const Basin basin(size);
      std::vector<double> ground = basin.terrain;
      const std::vector<std::uint8_t> cut{1, 0};
      const auto roofs =
          cut_back(basin.mesh, basin.owner, basin.city.roofs, cut, {slope, 2 * slope}, ground);
      EXPECT_EQ(roofs, std::vector<BuildingIndex>{0});
      int lowered = 0, at_the_other = 0;
      for (std::size_t v = 0; v < ground.size(); ++v) {
        const Point2 p = basin.mesh.vertices[v];
        const double away = distance(basin.low, p);
        EXPECT_LE(ground[v], basin.terrain[v]);
        if (basin.owner[v] == 0) {
          EXPECT_GE(ground[v], 0);  // below the roof is lower_at_walls' concern
          continue;
        }
        // Never deeper than the straight distance asks for; hardly higher where it is straight.
        EXPECT_GE(ground[v], std::min(basin.terrain[v], slope * away) - 1e-9);
        const bool in_front = p.y > 32 && p.y < 43 && p.x < basin.low.xmin;
        if (in_front) {
          EXPECT_LE(ground[v], std::min(basin.terrain[v], 2.04 * slope * away) + 1e-5);
        }
        lowered += ground[v] < basin.terrain[v] ? 1 : 0;
        at_the_other += ground[v] < basin.terrain[v] && basin.owner[v] == 1 ? 1 : 0;
      }
      EXPECT_GT(lowered, 10);
      EXPECT_GT(at_the_other, 0);
      int beside = 0;
      // No triangle outside is steeper than asked between what was lowered and what it came from.
      for (std::size_t t = 0; t < basin.mesh.triangles.size(); ++t) {
        if (basin.mesh.region[t] != kNoBuilding) continue;
        for (const VertexIndex a : basin.mesh.triangles[t])
          for (const VertexIndex b : basin.mesh.triangles[t]) {
            const auto u = static_cast<std::size_t>(a), v = static_cast<std::size_t>(b);
            if (basin.owner[v] == 0 || u == v) continue;
            const bool starts = basin.owner[u] == 0 || ground[u] < basin.terrain[u];
            if (!starts) continue;
            const Point2 p = basin.mesh.vertices[u], q = basin.mesh.vertices[v];
            const bool at_roof = basin.owner[u] == 0;
            EXPECT_LE(ground[v], (at_roof ? 0 : ground[u]) +
                                     (at_roof ? 1 : 2) * slope * std::hypot(p.x - q.x, p.y - q.y) +
                                     1e-5);
            if (at_roof) ++beside;
          }
      }
      EXPECT_GT(beside, 10);
    }
}

/// The same slope everywhere: the height is that over the distance from the wall.
TEST(CutBack, AgreesWithDistances) {
  const Basin basin(3);
  std::vector<double> ground = basin.terrain;
  cut_back(basin.mesh, basin.owner, basin.city.roofs, std::vector<std::uint8_t>{1, 0}, {1.5, 0.1},
           ground);
  int compared = 0;
  for (std::size_t v = 0; v < ground.size(); ++v) {
    const Point2 p = basin.mesh.vertices[v];
    if (p.y <= 32 || p.y >= 43 || p.x >= basin.low.xmin) continue;
    const double expected = std::min(basin.terrain[v], 1.5 * distance(basin.low, p));
    EXPECT_GE(ground[v], expected - 1e-9);
    EXPECT_LE(ground[v], 1.02 * expected + 1e-5);
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

TEST(CutBack, NothingChangesWithoutAMarkOrAboveTheTerrain) {
  const Basin basin(5);
  std::vector<double> ground = basin.terrain;
  for (const std::vector<std::uint8_t>& cut : {std::vector<std::uint8_t>{0, 0}, {0, 1}}) {
    EXPECT_TRUE(
        cut_back(basin.mesh, basin.owner, basin.city.roofs, cut, CutSlopes{}, ground).empty());
    EXPECT_EQ(ground, basin.terrain);
  }
}

TEST(CutBack, MarksTheRoofsWithBadCellsBesideThem) {
  // On a slope of 60 degrees, and a house on a plain.
  testing::SmallCity city;
  city.footprints = {testing::rectangle(20, 30, 34, 44), testing::rectangle(90, 30, 104, 44)};
  city.roofs = {35, 125};
  city.dtm = testing::raster_of(
      city.domain, [](double x, double) { return std::min(std::max(0.0, 1.732 * x), 120.0); });
  const auto result = testing::meshed(city, 4);
  int marks = 0;
  for (const double least : {0.5, 8.5, 60.0}) {
    std::set<BuildingIndex> expected;
    std::int64_t beside_the_first = 0;
    const CellQuality cells = measure_cells(result.mesh, 10'000'000);
    ASSERT_EQ(static_cast<std::int64_t>(cells.worst.size()), cells.histogram.cells());
    for (const WorstCell& cell : cells.worst) {
      if (cell.min_dihedral_deg >= least && cell.max_dihedral_deg <= 159.5) continue;
      const auto t = static_cast<std::size_t>(cell.triangle);
      if (result.mesh.ground.region[t] != kNoBuilding) continue;
      const auto& corners = result.mesh.ground.triangles[t];
      beside_the_first += std::any_of(corners.begin(), corners.end(), [&](VertexIndex v) {
        return result.plan.building[static_cast<std::size_t>(v)] == 0;
      });
      for (const VertexIndex v : corners) {
        const BuildingIndex b = result.plan.building[static_cast<std::size_t>(v)];
        if (b == kNoBuilding) continue;
        for (const VertexIndex u : corners)
          if (result.plan.ground[static_cast<std::size_t>(u)] >
              city.roofs[static_cast<std::size_t>(b)])
            expected.insert(b);
      }
    }
    std::vector<std::uint8_t> cut(2, 0);
    const AngleBounds bounds{least, 159.5};
    const std::int64_t marked = mark_buried_roofs(result.mesh, result.plan, bounds, cut);
    EXPECT_EQ(marked, static_cast<std::int64_t>(expected.size()));
    EXPECT_EQ(cut[0], expected.count(0));
    EXPECT_EQ(cut[1], 0);
    EXPECT_EQ(mark_buried_roofs(result.mesh, result.plan, bounds, cut), 0) << "marked twice";
    EXPECT_EQ(
        count_bad_cells(result.mesh, result.plan.building, bounds, std::vector<std::uint8_t>{1, 0}),
        beside_the_first);
    marks += cut[0];
  }
  EXPECT_GT(marks, 0);
}

TEST(CutBack, CellsAtDeeplyBuriedRoofsGetRoom) {
  testing::SmallCity city;
  city.footprints = {testing::rectangle(40, 30, 50, 50)};
  city.roofs = {38};
  city.dtm = testing::raster_of(city.domain, [](double x, double) { return x; });
  auto result = testing::meshed(city, 4);
  ColumnPlanOptions options;
  options.domain_height = 80;
  options.cut = {1};
  const ColumnPlan plan = plan_columns(result.mesh.ground, city.dtm, city.roofs,
                                       column_spacing(result.mesh.ground), options);
  EXPECT_GT(plan.lowered, result.plan.lowered);
  ColumnMesh mesh = divide_columns(result.mesh.ground, result.mesh.edges, plan);
  place_nodes(mesh, plan);
  require_valid(mesh);
  improve_columns(result.mesh);
  improve_columns(mesh);
  EXPECT_LT(measure_cells(result.mesh).histogram.min_dihedral_deg(), 8);
  EXPECT_GT(measure_cells(mesh).histogram.min_dihedral_deg(), 8);
  EXPECT_LT(measure_cells(mesh).histogram.max_dihedral_deg(), 160);
}

}  // namespace
}  // namespace tetropolis
