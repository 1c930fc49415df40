#include "volume/excavate/excavate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/volume/quality/cell_quality.h"

#include "core/infinity.h"
#include "support/explicit_mesh.h"
#include "support/indices.h"
#include "support/small_city.h"
#include "volume/column/fill_columns.h"
#include "volume/column/ground_heights.h"
#include "volume/excavate/find_sources.h"
#include "volume/quality/improve_columns.h"

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
  std::vector<RegionIndex> owner;
  std::vector<double> terrain;

  explicit Basin(double size) {
    city.footprints = {testing::rectangle(low.xmin, low.ymin, low.xmax, low.ymax),
                       testing::rectangle(high.xmin, high.ymin, high.xmax, high.ymax)};
    city.roofs = {0, 30};
    city.dtm =
        testing::raster_of(city.domain, [](double x, double) { return x < 90 ? 20.0 : -100.0; });
    mesh = mesh_ground(city.footprints, city.domain, {size, 25});
    owner = lowest_roofs(mesh, city.roofs);
    terrain = terrain_under(mesh, city.dtm);
  }
};

TEST(Excavate, GroundRisesFromTheRoofAsAsked) {
  for (const double slope : {1.0, 1.5, 3.0})
    for (const double size : {3.0, 8.0}) {
      SCOPED_TRACE(::testing::Message() << slope << " " << size);
      const Basin basin(size);
      std::vector<double> ground = basin.terrain;
      const ExcavationSources from = excavate(basin.mesh, basin.owner, basin.city.roofs,
                                              {{1, 0}, {}}, {slope, 2 * slope}, ground);
      EXPECT_EQ(from.roofs, testing::indices_of<BuildingIndex>({0}));
      EXPECT_TRUE(from.toes.empty());
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
      for (const TriangleIndex t : basin.mesh.triangles.indices()) {
        if (basin.mesh.inside_building(t)) continue;
        for (const VertexIndex u : basin.mesh.triangles[t])
          for (const VertexIndex v : basin.mesh.triangles[t]) {
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

/// Of a building with several roofs one alone may be marked, so its edge is told point by point.
TEST(Excavate, RoofsAreToldByBuildingOrByPoint) {
  const Basin basin(3.0);
  GroundMesh mesh = basin.mesh;
  mesh.regions[RegionIndex(1)].building = mesh.regions[RegionIndex(0)].building;
  std::vector<double> alone = basin.terrain, together = basin.terrain;
  const ExcavationMarks marks{{1, 0}, {}};
  const ExcavationSlopes slopes{1.5, 3};
  const ExcavationSources of_one =
      excavate(basin.mesh, basin.owner, basin.city.roofs, marks, slopes, alone);
  const ExcavationSources of_two =
      excavate(mesh, basin.owner, basin.city.roofs, marks, slopes, together);
  EXPECT_EQ(alone, together);
  EXPECT_EQ(of_one.roofs, testing::indices_of<BuildingIndex>({0}));
  EXPECT_TRUE(of_two.roofs.empty());
  EXPECT_GT(of_two.toes.size(), 10U);
  // Excavating anew from these points alone gives the same ground.
  ExcavationMarks points;
  points.toes.assign(mesh.vertices.size(), kInfinity);
  for (const Point3& toe : of_two.toes) {
    EXPECT_EQ(toe[2], 0);
    EXPECT_EQ(distance(basin.low, {toe[0], toe[1]}), 0);
    for (const VertexIndex v : mesh.vertices.indices())
      if (mesh.vertices[v] == Point2{toe[0], toe[1]}) points.toes[v] = toe[2];
  }
  std::vector<double> anew = basin.terrain;
  excavate(mesh, basin.owner, basin.city.roofs, points, slopes, anew);
  for (const VertexIndex v : mesh.vertices.indices()) {
    if (basin.owner[v] == 0) continue;
    EXPECT_NEAR(anew[v], together[v], 1e-9);
  }
}

/// The same slope everywhere: the height is that over the distance from the wall.
TEST(Excavate, AgreesWithDistances) {
  const Basin basin(3);
  std::vector<double> ground = basin.terrain;
  excavate(basin.mesh, basin.owner, basin.city.roofs, {{1, 0}, {}}, {1.5, 0.1}, ground);
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

/// What a sweep does not think worth the while would add up over a long hillside, and `check` goes
/// through the triangles in another order.
TEST(Excavate, DoesNotDependOnTheOrderOfTriangles) {
  testing::SmallCity city;
  city.dtm = testing::raster_of(city.domain, [](double x, double y) { return 3 * x + y; });
  GroundMesh mesh = mesh_ground({}, city.domain, {0.7, 25});
  const std::vector<RegionIndex> owner = lowest_roofs(mesh, city.roofs);
  std::vector<double> there = terrain_under(mesh, city.dtm), back = there;
  ExcavationMarks marks;
  marks.toes.assign(there.size(), kInfinity);
  for (std::size_t v = 0; v < there.size(); v += 397) marks.toes[v] = 0.4 * there[v];
  excavate(mesh, owner, {}, marks, ExcavationSlopes{}, there);
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  excavate(mesh, owner, {}, marks, ExcavationSlopes{}, back);
  double most = 0;
  for (std::size_t v = 0; v < there.size(); ++v)
    most = std::max(most, std::abs(there[v] - back[v]));
  EXPECT_LE(most, 1e-7);
}

TEST(Excavate, NothingChangesWithoutAMarkOrAboveTheTerrain) {
  const Basin basin(5);
  std::vector<double> ground = basin.terrain;
  const std::vector<double> no_toes(ground.size(), kInfinity);
  for (const ExcavationMarks& marks :
       {ExcavationMarks{}, {{0, 0}, {}}, {{0, 1}, {}}, {{}, no_toes}}) {
    const ExcavationSources from =
        excavate(basin.mesh, basin.owner, basin.city.roofs, marks, ExcavationSlopes{}, ground);
    EXPECT_TRUE(from.roofs.empty());
    EXPECT_TRUE(from.toes.empty());
    EXPECT_EQ(ground, basin.terrain);
  }
}

/// A cliff of 20 m along x = 60 that ends in a plain, and no building near.
struct Cliff {
  testing::SmallCity city;
  GroundMesh mesh;
  std::vector<RegionIndex> owner;
  std::vector<double> terrain;

  explicit Cliff(double size) {
    city.footprints = {testing::rectangle(10, 10, 20, 20)};
    city.roofs = {8};
    city.dtm =
        testing::raster_of(city.domain, [](double x, double) { return x < 60 ? 0.0 : 20.0; });
    mesh = mesh_ground(city.footprints, city.domain, {size, 25});
    owner = lowest_roofs(mesh, city.roofs);
    terrain = terrain_under(mesh, city.dtm);
  }
};

/// Toes that make the bad triangles as gentle as asked, and no others.
TEST(Excavate, GentleMarksAreOfBadTrianglesOnly) {
  const Basin basin(6);
  ColumnPlan plan =
      plan_columns(basin.mesh, basin.city.dtm, basin.city.roofs, column_spacing(basin.mesh), {});
  ColumnMesh mesh = divide_columns(basin.mesh, build_edge_graph(basin.mesh), plan);
  for (const double slope : {1.0, 0.5}) {
    ExcavationMarks marks;
    marks.toes.assign(plan.ground.size(), kInfinity);
    std::vector<std::uint8_t> bad(mesh.triangle_count(), 0);
    EXPECT_EQ(mark_gentle(mesh, plan, bad, slope, marks), 0);
    for (std::size_t t = 0; t < bad.size(); t += 3) bad[t] = 1;
    const std::int64_t marked = mark_gentle(mesh, plan, bad, slope, marks);
    EXPECT_GT(marked, 10);
    const auto start = [&](VertexIndex v, double high) {
      const double roof = plan.lowest_roof[v] == kNoRegion ? kInfinity : plan.lowest_roof_at(v);
      return roof < high ? roof : plan.ground[v];
    };
    std::vector<double> expected(plan.ground.size(), kInfinity);
    for (const TriangleIndex t : indices<TriangleIndex>(bad.size())) {
      if (bad[t] == 0 || mesh.inside_building(t)) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto corner = [&](std::size_t k) { return mesh.ground.triangles[t][(i + k) % 3]; };
        const VertexIndex v = corner(0), a = corner(1), b = corner(2);
        const Point2 p = mesh.ground.vertices[v], q = mesh.ground.vertices[a],
                     r = mesh.ground.vertices[b];
        double most = kInfinity;  // along the edge opposite, in small steps
        for (int step = 0; step <= 1000; ++step) {
          const double s = step / 1000.0;
          const double z = (1 - s) * start(a, plan.ground[v]) + s * start(b, plan.ground[v]);
          most = std::min(most, z + slope * std::hypot(p.x - (1 - s) * q.x - s * r.x,
                                                       p.y - (1 - s) * q.y - s * r.y));
        }
        if (most < plan.ground[v] - 0.01) expected[v] = std::min(expected[v], most);
      }
    }
    for (std::size_t v = 0; v < expected.size(); ++v) {
      if (expected[v] == kInfinity) {
        EXPECT_TRUE(marks.toes[v] == kInfinity || marks.toes[v] > plan.ground[v] - 0.02);
      } else {
        EXPECT_NEAR(marks.toes[v], expected[v], 0.011);
      }
    }
    EXPECT_EQ(mark_gentle(mesh, plan, bad, slope, marks), 0);  // once
  }
}

TEST(Excavate, GroundRisesFromTheToeOfACliffAsAsked) {
  const Cliff cliff(4);
  std::size_t toe = 0;
  for (std::size_t v = 0; v < cliff.mesh.vertices.size(); ++v) {
    const auto off = [&](std::size_t u) {
      return std::hypot(cliff.mesh.vertices[u].x - 57, cliff.mesh.vertices[u].y - 50);
    };
    if (off(v) < off(toe)) toe = v;
  }
  const Point2 at = cliff.mesh.vertices[toe];
  for (const double below : {0.0, 0.5}) {
    std::vector<double> ground = cliff.terrain;
    ExcavationMarks marks;
    marks.toes.assign(ground.size(), kInfinity);
    marks.toes[toe] = cliff.terrain[toe] - below;
    const ExcavationSources from =
        excavate(cliff.mesh, cliff.owner, cliff.city.roofs, marks, {1, 1}, ground);
    EXPECT_TRUE(from.roofs.empty());
    ASSERT_EQ(from.toes.size(), 1U);
    EXPECT_EQ(from.toes[0], (Point3{at.x, at.y, marks.toes[toe]}));
    EXPECT_EQ(ground[toe], marks.toes[toe]);
    const auto is_cut = [&](std::size_t v) { return v == toe || ground[v] < cliff.terrain[v]; };
    int lowered = 0;
    for (std::size_t v = 0; v < ground.size(); ++v) {
      const Point2 p = cliff.mesh.vertices[v];
      EXPECT_LE(ground[v], cliff.terrain[v]);
      // Never deeper than the straight distance asks for.
      const double most = marks.toes[toe] + std::hypot(p.x - at.x, p.y - at.y);
      EXPECT_GE(ground[v], std::min(cliff.terrain[v], most) - 1e-9);
      if (v != toe && is_cut(v)) ++lowered;
    }
    EXPECT_GT(lowered, 20);
    for (const TriangleIndex t : cliff.mesh.triangles.indices())
      for (std::size_t i = 0; i < 3 && !cliff.mesh.inside_building(t); ++i) {
        VertexIndex u = cliff.mesh.triangles[t][i], v = cliff.mesh.triangles[t][(i + 1) % 3];
        if (ground[u] > ground[v]) std::swap(u, v);
        const Point2 p = cliff.mesh.vertices[u], q = cliff.mesh.vertices[v];
        if (is_cut(u)) {
          EXPECT_LE(ground[v], ground[u] + std::hypot(p.x - q.x, p.y - q.y) + 1e-5);
        }
      }
  }
}

TEST(Excavate, MarksTheToesOfCliffsWithBadCells) {
  const Cliff cliff(4);
  const auto result = testing::meshed(cliff.city, 4);
  const CellQuality cells = measure_cells(result.mesh, 10'000'000);
  std::size_t most = 0;
  for (const double least : {0.5, 14.0, 60.0})
    for (const ToeRule rule :
         {ToeRule{0.5, 0.0}, {0.5, 0.5}, {3.0, 0.0}, {3.0, 0.5}, {100.0, 0.5}}) {
      const AngleBounds bounds{least, 159.5};
      std::int64_t bad = 0;
      std::vector<std::uint8_t> bad_triangles(result.mesh.triangle_count(), 0);
      std::vector<std::pair<TriangleIndex, double>> steep;  // triangles and where toes end
      for (const WorstCell& cell : cells.worst) {
        if (cell.min_dihedral_deg >= least && cell.max_dihedral_deg <= 159.5) continue;
        ++bad;
        const TriangleIndex t = cell.triangle;
        bad_triangles[t] = 1;
        if (result.mesh.ground.inside_building(t)) continue;
        // The steepest direction, by looking into all of them.
        std::array<Point3, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
          const VertexIndex v = result.mesh.ground.triangles[t][i];
          const Point2 q = result.mesh.ground.vertices[v];
          p[i] = {q.x, q.y, result.plan.ground[v]};
        }
        std::sort(p.begin(), p.end(), [](const Point3& a, const Point3& b) { return a[2] < b[2]; });
        // Where the plane has the middle height on the line from the lowest to the highest.
        const double share = p[2][2] > p[0][2] ? (p[1][2] - p[0][2]) / (p[2][2] - p[0][2]) : 0;
        const double lx = p[0][0] + share * (p[2][0] - p[0][0]) - p[1][0];
        const double ly = p[0][1] + share * (p[2][1] - p[0][1]) - p[1][1];
        const double across =
            std::abs(lx * (p[2][1] - p[0][1]) - ly * (p[2][0] - p[0][0])) / std::hypot(lx, ly);
        if (!((p[2][2] - p[0][2]) / across > rule.slope)) continue;
        steep.emplace_back(t, p[0][2] + rule.share * (p[2][2] - p[0][2]));
      }
      EXPECT_EQ(testing::count_bad_cells(result.mesh, bounds), bad);
      ExcavationMarks marks;
      marks.toes.assign(result.plan.ground.size(), kInfinity);
      const std::int64_t marked =
          mark_slope_toes(result.mesh, result.plan, bad_triangles, rule, marks);
      std::set<std::size_t> allowed;
      for (const auto& [t, end] : steep)
        for (const VertexIndex c : result.mesh.ground.triangles[t]) {
          const auto v = static_cast<std::size_t>(c);
          if (result.plan.ground[v] > end) continue;
          allowed.insert(v);
          EXPECT_EQ(marks.toes[v], result.plan.ground[v]) << "triangle " << t;
        }
      std::int64_t toes = 0;
      for (std::size_t v = 0; v < marks.toes.size(); ++v) {
        if (marks.toes[v] == kInfinity) continue;
        ++toes;
        EXPECT_TRUE(allowed.count(v) == 1 && marks.toes[v] == result.plan.ground[v]) << v;
      }
      EXPECT_EQ(toes, marked);
      EXPECT_EQ(mark_slope_toes(result.mesh, result.plan, bad_triangles, rule, marks), 0)
          << "marked twice";
      most = std::max(most, static_cast<std::size_t>(toes));
    }
  EXPECT_GT(most, 10U);
}

/// Seen from either end of the wall, the vertex before its middle is no steep rise.
TEST(Excavate, ExcavatesWhatRisesBeforeTheMiddleOfASunkenWall) {
  GroundMesh mesh;
  mesh.vertices = {{0, 0}, {2.4, 0}, {1.2, 0.6}, {1.2, -2}};
  mesh.triangles = testing::triangles_of({{0, 1, 2}, {1, 0, 3}});
  mesh.region = testing::indices_of<RegionIndex>({1, 0});
  mesh.regions = testing::regions_of_buildings(1);
  ColumnPlan plan;
  plan.ground = {-1.7, -1.7, 0, -1.7};
  plan.roofs.flat = {-0.7};
  plan.lowest_roof = lowest_roofs(mesh, plan.roofs);
  ColumnMesh columns;
  columns.ground = mesh;
  ExcavationMarks marks;
  marks.toes.assign(4, kInfinity);
  const std::vector<std::uint8_t> bad{1, 0};
  const ExcavationSlopes slopes;
  EXPECT_EQ(mark_slope_toes(columns, plan, bad, {slopes.at_source, 0.5}, marks), 2);
  std::vector<double> ground = plan.ground;
  excavate(mesh, plan.lowest_roof, plan.roofs, marks, slopes, ground);
  EXPECT_NEAR(ground[2], -1.7 + 0.6 * slopes.at_source, 1e-12);
}

TEST(Excavate, MarksTheToesOfWallsTooLowForTheEdgesBesideThem) {
  testing::SmallCity city;
  city.footprints = {testing::rectangle(30, 30, 50, 44), testing::rectangle(80, 30, 90, 40)};
  city.roofs = {1.2, 9};
  city.dtm = testing::raster_of(city.domain, [](double, double) { return 0.0; });
  const auto result = testing::meshed(city, 10);
  ExcavationMarks marks;
  marks.toes.assign(result.plan.ground.size(), kInfinity);
  const std::vector<std::uint8_t> all_triangles(result.mesh.triangle_count(), 1);
  const std::int64_t marked =
      mark_slope_toes(result.mesh, result.plan, all_triangles, {0.5, 0}, marks);
  EXPECT_GT(marked, 5);
  const double tangent = std::tan(15 * std::numbers::pi / 180);
  int toes = 0;
  for (const VertexIndex v : indices<VertexIndex>(marks.toes.size())) {
    double longest = 0;
    for (const TriangleIndex t : result.mesh.ground.triangles.indices()) {
      const auto& corners = result.mesh.ground.triangles[t];
      if (result.mesh.inside_building(t) ||
          std::find(corners.begin(), corners.end(), v) == corners.end())
        continue;
      for (const VertexIndex u : corners) {
        const Point2 p = result.mesh.ground.vertices[v];
        const Point2 q = result.mesh.ground.vertices[static_cast<std::size_t>(u)];
        longest = std::max(longest, std::hypot(p.x - q.x, p.y - q.y));
      }
    }
    const bool is_low = result.plan.lowest_roof[v] == 0 && 1.2 < tangent * longest;
    EXPECT_EQ(marks.toes[v] < 1e9, is_low);
    if (is_low) {
      EXPECT_NEAR(marks.toes[v], 1.2 - tangent * longest, 1e-9);
      ++toes;
    }
  }
  EXPECT_GT(toes, 5);
}

TEST(Excavate, MarksTheRoofsWithBadCellsBesideThem) {
  // On a slope of 60 degrees, and a house on a plain.
  testing::SmallCity city;
  city.footprints = {testing::rectangle(20, 30, 34, 44), testing::rectangle(90, 30, 104, 44)};
  city.roofs = {35, 125};
  city.dtm = testing::raster_of(
      city.domain, [](double x, double) { return std::min(std::max(0.0, 1.732 * x), 120.0); });
  const auto result = testing::meshed(city, 4);
  int all = 0;
  for (const double least : {0.5, 8.5, 60.0}) {
    std::set<RegionIndex> expected;
    std::vector<std::uint8_t> bad(result.mesh.triangle_count(), 0);
    const CellQuality cells = measure_cells(result.mesh, 10'000'000);
    ASSERT_EQ(static_cast<std::int64_t>(cells.worst.size()), cells.histogram.cells());
    for (const WorstCell& cell : cells.worst) {
      if (cell.min_dihedral_deg >= least && cell.max_dihedral_deg <= 159.5) continue;
      const TriangleIndex t = cell.triangle;
      bad[t] = 1;
      if (result.mesh.ground.inside_building(t)) continue;
      const auto& corners = result.mesh.ground.triangles[t];
      for (const VertexIndex v : corners) {
        const RegionIndex b = result.plan.lowest_roof[v];
        if (b == kNoRegion) continue;
        for (const VertexIndex u : corners)
          if (result.plan.ground[u] > city.roofs[b]) expected.insert(b);
      }
    }
    ExcavationMarks marks{{0, 0}, {}};
    const std::vector<std::uint8_t>& cut = marks.roofs;
    const std::int64_t marked = mark_buried_roofs(result.mesh, result.plan, bad, marks);
    EXPECT_EQ(marked, static_cast<std::int64_t>(expected.size()));
    EXPECT_EQ(cut[0], expected.count(RegionIndex(0)));
    EXPECT_EQ(cut[1], 0);
    EXPECT_EQ(mark_buried_roofs(result.mesh, result.plan, bad, marks), 0) << "marked twice";
    all += cut[0];
  }
  EXPECT_GT(all, 0);
}

/// Two pieces of lowered ground, far apart: in one are fewer bad triangles than before, in the
/// other more. Only the marks of the first stay, and those made before.
TEST(Excavate, MarksStayWhereTheyHelp) {
  testing::SmallCity city;
  city.footprints = {testing::rectangle(20, 30, 30, 50), testing::rectangle(90, 30, 100, 50)};
  city.roofs = {12, 12};
  city.dtm = testing::raster_of(city.domain, [](double, double) { return 0.0; });
  const auto result = testing::meshed(city, 5);
  const GroundMesh& ground = result.mesh.ground;
  const auto near = [&](std::size_t v, const Polygon& building) {
    return distance(bounds(building.outer), ground.vertices[v]) < 8;
  };
  std::vector<double> after = result.plan.ground;
  for (std::size_t v = 0; v < after.size(); ++v)
    if (near(v, city.footprints[0]) || near(v, city.footprints[1])) after[v] -= 1;
  std::vector<std::uint8_t> bad_before(ground.triangles.size(), 0), bad_after = bad_before;
  for (std::size_t t = 0; t < ground.triangles.size(); ++t) {
    const auto v = static_cast<std::size_t>(ground.triangles[t][0]);
    if (near(v, city.footprints[0])) bad_before[t] = 1;
    if (near(v, city.footprints[1])) bad_after[t] = 1;
  }
  const std::size_t n = after.size();
  std::size_t first = n, second = n, far = n;
  for (std::size_t v = 0; v < n; ++v) {
    if (near(v, city.footprints[0])) first = v;
    if (near(v, city.footprints[1])) second = v;
    if (!near(v, city.footprints[0]) && !near(v, city.footprints[1]) && ground.vertices[v].x > 55 &&
        ground.vertices[v].x < 65)
      far = v;
  }
  ASSERT_LT(std::max({first, second, far}), n);
  ExcavationMarks before{{0, 0}, std::vector<double>(n, kInfinity)};
  before.toes[far] = -3;
  ExcavationMarks marks = before;
  marks.roofs = {1, 1};
  marks.toes[first] = marks.toes[second] = -1;
  ExcavationMarks expected = before;
  expected.roofs = {1, 0};
  expected.toes[first] = -1;
  keep_helpful_marks(result.mesh, result.plan.lowest_roof,
                     {result.plan.ground, after, bad_before, bad_after}, before, marks);
  EXPECT_EQ(marks, expected);
}

TEST(Excavate, CellsAtDeeplyBuriedRoofsGetRoom) {
  testing::SmallCity city;
  city.footprints = {testing::rectangle(40, 30, 50, 50)};
  city.roofs = {38};
  city.dtm = testing::raster_of(city.domain, [](double x, double) { return x; });
  auto result = testing::meshed(city, 4);
  ColumnPlanOptions options;
  options.domain_height = 80;
  std::vector<double> excavated = terrain_under(result.mesh.ground, city.dtm);
  excavate(result.mesh.ground, result.plan.lowest_roof, city.roofs, {{1}, {}}, {}, excavated);
  const std::vector<std::uint8_t> deep_walls{1};
  options.excavated = excavated;
  options.deep_walls = deep_walls;
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
