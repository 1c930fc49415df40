#include "tetropolis/ground/triangulation.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "tetropolis/core/error.h"

#include "geometry/predicates.h"
#include "ground_cases.h"
#include "support/indices.h"

namespace tetropolis {
namespace {

using testing::edges_of;
using testing::indices_of;
using testing::triangles_of;

using testing::add_ring;
using testing::lines;
using testing::Random;
using testing::rectangle_ring;

double total_area(const Triangulation& t) {
  double sum = 0;
  for (const auto& v : t.triangles) {
    const Point2 a = t.points[static_cast<std::size_t>(v[0])];
    const Point2 b = t.points[static_cast<std::size_t>(v[1])];
    const Point2 c = t.points[static_cast<std::size_t>(v[2])];
    sum += 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  }
  return sum;
}

double hull_area(std::vector<Point2> points) {
  std::sort(points.begin(), points.end(),
            [](Point2 p, Point2 q) { return p.x != q.x ? p.x < q.x : p.y < q.y; });
  std::vector<Point2> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Point2 p : points) {
      while (hull.size() >= base + 2 && orient2d(hull[hull.size() - 2], hull.back(), p) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  double sum = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point2 o = hull[0], p = hull[i], q = hull[(i + 1) % hull.size()];
    sum += 0.5 * ((p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x));
  }
  return sum;
}

bool crosses(Point2 a, Point2 b, Point2 c, Point2 d) {
  return orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0;
}

// Every vertex inside a triangle's circumcircle is hidden from the triangle's centre by a segment
// (or in line with the end of one).
void expect_brute_force_delaunay(const Triangulation& t) {
  for (const auto& v : t.triangles) {
    const auto at = [&](std::size_t i) { return t.points[static_cast<std::size_t>(v[i])]; };
    const Point2 centre{(at(0).x + at(1).x + at(2).x) / 3, (at(0).y + at(1).y + at(2).y) / 3};
    for (const Point2 p : t.points) {
      if (incircle(at(0), at(1), at(2), p) <= 0) continue;
      bool hidden = false;
      for (const auto& s : t.segments) {
        const Point2 a = t.points[static_cast<std::size_t>(s[0])];
        const Point2 b = t.points[static_cast<std::size_t>(s[1])];
        if (crosses(centre, p, a, b)) hidden = true;
        for (const Point2 e : {a, b})
          if (!(e == p) && orient2d(centre, p, e) == 0) hidden = true;
      }
      EXPECT_TRUE(hidden) << "(" << p.x << ", " << p.y << ") is in a circumcircle";
    }
  }
}

void expect_hull(const PlanarGraph& graph) {
  const Triangulation t = constrained_delaunay(graph, {.convex_hull = true});
  ASSERT_EQ(lines(validate(graph, t)), "") << "seed " << testing::test_seed();
  const double expected = hull_area(graph.points);
  EXPECT_NEAR(total_area(t), expected, 1e-9 * (1 + expected));
  if (graph.points.size() < 60) expect_brute_force_delaunay(t);
}

TEST(Triangulation, RandomPointsAreDelaunay) {
  Random random(1);
  for (int n : {3, 4, 5, 6, 10, 30, 50}) {
    for (int i = 0; i < 60; ++i) {
      PlanarGraph graph;
      for (int k = 0; k < n; ++k) graph.points.push_back(random.point(10));
      expect_hull(graph);
    }
  }
  PlanarGraph many;
  for (int k = 0; k < 20000; ++k) many.points.push_back(random.point(1000));
  expect_hull(many);
}

TEST(Triangulation, GridsWithManyCocircularAndEqualPoints) {
  Random random(2);
  for (int i = 0; i < 400; ++i) {
    PlanarGraph graph;
    const int size = random.integer(1, 6), n = random.integer(3, 55);
    for (int k = 0; k < n; ++k) graph.points.push_back(random.grid_point(size));
    expect_hull(graph);
  }
  PlanarGraph full;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) full.points.push_back({0.1 * i, 0.1 * j});
  expect_hull(full);
}

TEST(Triangulation, PointsOnCirclesAndAlmostOnLines) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    PlanarGraph circle, line;
    const int n = random.integer(3, 50);
    for (int k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * k / n;
      circle.points.push_back({6.4e6 + std::cos(a), 6.4e6 + std::sin(a)});
      const double t = random.real(0, 1);
      line.points.push_back({t * 3 + 1, t * 7 - 2});
    }
    circle.points.push_back({6.4e6, 6.4e6});
    expect_hull(circle);
    expect_hull(line);
  }
}

// The same vertices, and only triangles that are possible, whatever the order of the input.
TEST(Triangulation, InGeneralPositionTheOrderOfPointsDoesNotMatter) {
  Random random(4);
  PlanarGraph graph;
  for (int k = 0; k < 300; ++k) graph.points.push_back(random.point(1));
  const auto canonical = [](const Triangulation& t) {
    std::set<std::set<std::pair<double, double>>> set;
    for (const auto& v : t.triangles) {
      std::set<std::pair<double, double>> triangle;
      for (const VertexIndex i : v) {
        const Point2 p = t.points[static_cast<std::size_t>(i)];
        triangle.emplace(p.x, p.y);
      }
      set.insert(triangle);
    }
    return set;
  };
  const auto expected = canonical(constrained_delaunay(graph));
  std::reverse(graph.points.begin(), graph.points.end());
  EXPECT_EQ(canonical(constrained_delaunay(graph)), expected);
}

TEST(Triangulation, CollinearAndFewPointsHaveNoTriangles) {
  for (const int n : {0, 1, 2, 3, 10}) {
    PlanarGraph graph;
    for (int k = 0; k < n; ++k) graph.points.push_back({1.0 * (k * 7 % 10), 3.0 * (k * 7 % 10)});
    graph.points.insert(graph.points.end(), graph.points.begin(), graph.points.end());
    if (n == 10) graph.segments = edges_of({{0, 1}, {1, 0}, {12, 5}, {3, 3}});
    const Triangulation t = constrained_delaunay(graph);
    EXPECT_TRUE(t.triangles.empty());
    EXPECT_EQ(static_cast<int>(t.points.size()), n);
    EXPECT_EQ(lines(validate(graph, t)), "");
    // 0 to 7 and 4 to 5 along the line, in steps of one: no step twice.
    EXPECT_EQ(t.segments.size(), n == 10 ? 7U : 0U);
  }
}

TEST(Triangulation, DuplicatePointsShareAVertexAndKeepTheirOrder) {
  PlanarGraph graph;
  graph.points = {{5, 5}, {0, 0}, {5, 5}, {1, 0}, {0, 0}, {0, 1}};
  const Triangulation t = constrained_delaunay(graph);
  EXPECT_EQ(t.input_vertex, (indices_of<VertexIndex>({0, 1, 0, 2, 1, 3})));
  EXPECT_EQ(t.points, (std::vector<Point2>{{5, 5}, {0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(t.triangles.size(), 2U);
}

PlanarGraph random_segments(Random& random, int points, int segments, bool grid, double offset) {
  PlanarGraph graph;
  for (int k = 0; k < points; ++k) {
    Point2 p = grid ? random.grid_point(8) : random.point(8);
    graph.points.push_back({p.x + offset, p.y + offset});
  }
  for (int k = 0; k < segments; ++k)
    graph.segments.push_back(
        {VertexIndex(random.integer(0, points - 1)), VertexIndex(random.integer(0, points - 1))});
  return graph;
}

TEST(Triangulation, SegmentsThatCrossOverlapAndTouch) {
  Random random(5);
  for (int i = 0; i < 1500; ++i) {
    const double offset = i % 3 == 0 ? 6.4e6 : 0;
    const PlanarGraph graph =
        random_segments(random, random.integer(3, 25), random.integer(1, 12), i % 2 == 0, offset);
    const Triangulation t = constrained_delaunay(graph, {.convex_hull = true});
    ASSERT_EQ(lines(validate(graph, t)), "") << "case " << i << " seed " << testing::test_seed();
  }
}

TEST(Triangulation, ManySegmentsThroughOneAnother) {
  Random random(6);
  PlanarGraph graph = random_segments(random, 400, 200, false, 0);
  for (std::size_t s = 0; s < 200; ++s)
    graph.segments[s] = {VertexIndex(2 * s), VertexIndex(2 * s + 1)};
  const Triangulation t = constrained_delaunay(graph, {.convex_hull = true});
  EXPECT_EQ(lines(validate(graph, t)), "");
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < graph.segments.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto at = [&](std::size_t s, std::size_t k) {
        return graph.points[static_cast<std::size_t>(graph.segments[s][k])];
      };
      pairs += crosses(at(i, 0), at(i, 1), at(j, 0), at(j, 1)) ? 1 : 0;
    }
  EXPECT_EQ(t.crossings, pairs);
}

TEST(Triangulation, SegmentsAlmostThroughOnePointAndAlmostParallel) {
  Random random(7);
  for (int i = 0; i < 300; ++i) {
    PlanarGraph graph;
    const double offset = i % 2 == 0 ? 6.4e6 : 0;
    for (int k = 0; k < 8; ++k) {
      const double a = i % 3 == 0 ? 1e-9 * k : random.real(0, 6.3);
      const Point2 u{std::cos(a), std::sin(a)};
      graph.points.push_back({offset + 3 * u.x, offset + 3 * u.y});
      graph.points.push_back({offset - 4 * u.x, offset - 4 * u.y});
      graph.segments.push_back({VertexIndex(2 * k), VertexIndex(2 * k + 1)});
    }
    graph.points.push_back({offset, offset + 9});
    const Triangulation t = constrained_delaunay(graph, {.convex_hull = true});
    ASSERT_EQ(lines(validate(graph, t)), "") << "case " << i;
  }
}

TEST(Triangulation, VerticesOnASegmentAtTheLastBitOfItsEnds) {
  const double end = std::nextafter(1e6, 0.0);
  PlanarGraph graph;
  graph.points = {{0, 0},      {1e6, 0},   {end, 0}, {std::nextafter(end, 0.0), 0},
                  {1e-90, 0},  {1e-12, 0}, {5, 7},   {5, -9},
                  {1e6, 1e-7}, {0, -1e-9}};
  graph.segments = edges_of({{0, 1}, {9, 8}, {1, 0}, {3, 5}});
  const Triangulation t = constrained_delaunay(graph, {.convex_hull = true});
  EXPECT_EQ(lines(validate(graph, t)), "");
}

TEST(Triangulation, BruteForceWithSegmentsThatDoNotCross) {
  Random random(8);
  for (int i = 0; i < 150; ++i) {
    PlanarGraph graph;
    for (int k = 0; k < 30; ++k) graph.points.push_back(random.point(10));
    for (int k = 0; k < 60; ++k) {
      const VertexIndex a(random.integer(0, 29)), b(random.integer(0, 29));
      const auto at = [&](VertexIndex v) { return graph.points[static_cast<std::size_t>(v)]; };
      const bool free =
          std::none_of(graph.segments.begin(), graph.segments.end(),
                       [&](const auto& s) { return crosses(at(a), at(b), at(s[0]), at(s[1])); });
      if (a != b && free) graph.segments.push_back({a, b});
    }
    const Triangulation t = constrained_delaunay(graph, {.convex_hull = true});
    EXPECT_EQ(t.crossings, 0);
    expect_hull(graph);
  }
}

TEST(Triangulation, CarvesOutsideHolesAndFloodsRegions) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 10, 10));
  add_ring(graph, rectangle_ring(2, 2, 4, 4));
  add_ring(graph, rectangle_ring(6, 6, 8, 8));
  graph.holes = {{3, 3}, {100, 100}};
  graph.regions = {{{7, 7}, 5, 0}, {{1, 1}, 6, 0}};
  graph.points.push_back({12, 5});  // a lone point outside
  const Triangulation t = constrained_delaunay(graph);
  EXPECT_EQ(lines(validate(graph, t)), "");
  EXPECT_DOUBLE_EQ(total_area(t), 96);
  for (std::size_t i = 0; i < t.triangles.size(); ++i) {
    double x = 0, y = 0;
    for (const VertexIndex v : t.triangles[i]) {
      x += t.points[static_cast<std::size_t>(v)].x / 3;
      y += t.points[static_cast<std::size_t>(v)].y / 3;
    }
    EXPECT_EQ(t.triangle_regions[i], x > 6 && x < 8 && y > 6 && y < 8 ? 5 : 6);
  }
  // Sides win over seeds.
  graph.segment_sides.assign(graph.segments.size(), {kUnmarkedSide, kUnmarkedSide});
  for (std::size_t s = 8; s < 12; ++s) graph.segment_sides[s] = {77, 78};
  const Triangulation sides = constrained_delaunay(graph);
  const std::set<std::int32_t> regions(sides.triangle_regions.begin(),
                                       sides.triangle_regions.end());
  EXPECT_EQ(regions, (std::set<std::int32_t>{77, 78}));
}

TEST(Triangulation, CarvesWhatAnOpenChainDoesNotEnclose) {
  PlanarGraph graph;
  graph.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  graph.segments = edges_of({{0, 1}, {1, 2}, {2, 3}});
  EXPECT_TRUE(constrained_delaunay(graph).triangles.empty());
  EXPECT_EQ(constrained_delaunay(graph, {.convex_hull = true}).triangles.size(), 2U);
}

TEST(Triangulation, MarkersAndInputsOfSubsegments) {
  PlanarGraph graph;
  graph.points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 0}, {2, 0}};
  graph.segments = edges_of({{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}});
  graph.segment_markers = {10, 11, 12, 13, 14, 15};
  const Triangulation t = constrained_delaunay(graph);
  EXPECT_EQ(lines(validate(graph, t)), "");
  EXPECT_EQ(t.crossings, 1);
  EXPECT_EQ(t.points.back(), (Point2{2, 2}));
  std::vector<int> pieces(6, 0);
  for (std::size_t s = 0; s < t.segments.size(); ++s) {
    EXPECT_EQ(t.segment_markers[s], 10 + t.segment_inputs[s]);
    ++pieces[static_cast<std::size_t>(t.segment_inputs[s])];
  }
  EXPECT_EQ(pieces, (std::vector<int>{3, 1, 1, 1, 2, 2}));
}

TEST(Triangulation, RefusesUnusableInputByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto message = [](const PlanarGraph& graph) -> std::string {
    try {
      constrained_delaunay(graph);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInput);
      return e.what();
    }
    return "";
  };
  PlanarGraph graph;
  for (const double bad : {nan, infinity, -infinity, 1e200}) {
    graph.points = {{0, 0}, {1, 0}, {bad, 1}};
    EXPECT_NE(message(graph).find("point 2"), std::string::npos);
  }
  graph.points = {{0, 0}, {1, 0}, {1, 1}};
  graph.segments = edges_of({{0, 1}, {1, 3}});
  EXPECT_NE(message(graph).find("segment 1"), std::string::npos);
  graph.segments = edges_of({{0, 1}});
  graph.segment_markers = {1, 2};
  EXPECT_NE(message(graph).find("segment_markers"), std::string::npos);
  graph.segment_markers.clear();
  graph.holes = {{nan, 0}};
  EXPECT_NE(message(graph).find("hole 0"), std::string::npos);
  // What is too small beside the rest to be told from zero, wherever it is.
  const std::string small = "is too small to be told from zero";
  for (const double tiny : {1e-101, -1e-300, 5e-324}) {
    graph.holes.clear();
    graph.points[2] = {1, tiny};
    EXPECT_NE(message(graph).find(small), std::string::npos) << tiny;
    graph.points[2] = {1, 1};
    graph.holes = {{0.5, tiny}};
    EXPECT_NE(message(graph).find(small), std::string::npos) << tiny;
  }
  graph.holes.clear();
  graph.points[2] = {1e30, 1e-80};
  EXPECT_NE(message(graph).find("magnitude 1e-80 beside one of 1e+30 " + small), std::string::npos);
  graph.points[2] = {1e10, 1e-80};
  EXPECT_EQ(message(graph), "");
}

TEST(Triangulation, GivesUpWherePointsAreNearerThanTheirPrecision) {
  // All points but one within a few units in the last place of their coordinates.
  const double u = 0x1p-30, v = 0x1p-52;
  PlanarGraph map, unit;
  for (const Point2 p : {Point2{0, 2}, {1, 2}, {1, 1}, {1, 0}, {0, 3}, {902, 0}})
    map.points.push_back({6.4e6 + p.x * u, 6.4e6 + p.y * u});
  map.points.push_back({12800001, 0x1.24f800c3a7f8fp+23});
  map.segments = edges_of({{3, 6}});
  for (const Point2 p : {Point2{2, 1}, {1, 6}, {0, 2}, {2, 2}, {958, 0}})
    unit.points.push_back({1 + p.x * v, 1 + p.y * v});
  unit.points.push_back({3, 0x1.3e7b6d0ep+1});
  unit.segments = edges_of({{0, 5}});
  for (const PlanarGraph* graph : {&map, &unit}) {
    try {
      constrained_delaunay(*graph, {.convex_hull = true});
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInput);
      const std::string text = e.what();
      EXPECT_EQ(text.find("segment 0: from ("), 0U) << text;
      EXPECT_NE(text.find("nearer to one another than the precision"), std::string::npos) << text;
    }
  }
}

TEST(Triangulation, RealGraphs) {
  TETROPOLIS_REQUIRE_DATA(folder, "stockholm_case55_pslg");
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".pslg") continue;
    const PlanarGraph graph = testing::read_pslg(entry.path());
    for (const bool hull : {false, true}) {
      const Triangulation t = constrained_delaunay(graph, {.convex_hull = hull});
      EXPECT_EQ(lines(validate(graph, t)), "") << entry.path();
    }
    ++files;
  }
  EXPECT_GE(files, 89);
}

TEST(Triangulation, ChecksNoticeDamage) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 4, 1));
  graph.points.push_back({2.2, 0.4});
  const Triangulation good = constrained_delaunay(graph);
  ASSERT_EQ(lines(validate(graph, good)), "");
  Triangulation bad = good;
  std::swap(bad.triangles[0][0], bad.triangles[0][1]);
  EXPECT_NE(lines(validate(graph, bad)), "");
  bad = good;
  bad.triangles.push_back(bad.triangles[0]);
  bad.triangle_regions.push_back(0);
  EXPECT_NE(lines(validate(graph, bad)), "");
  bad = good;
  bad.triangles.pop_back();
  bad.triangle_regions.pop_back();
  EXPECT_NE(lines(validate(graph, bad)), "");
  bad = good;
  bad.triangle_regions[0] = 9;
  EXPECT_NE(lines(validate(graph, bad)), "");
  bad = good;
  bad.points[0].x -= 1e-3;
  EXPECT_NE(lines(validate(graph, bad)), "");
  bad = good;
  bad.segments.pop_back();
  EXPECT_NE(lines(validate(graph, bad)), "");
  // The other diagonal of a kite.
  Triangulation kite;
  kite.points = {{0, 0}, {2, -0.5}, {4, 0}, {2, 0.5}};
  kite.triangles = triangles_of({{0, 1, 2}, {0, 2, 3}});
  const auto rim = edges_of({{0, 1}, {1, 2}, {2, 3}, {3, 0}});
  EXPECT_EQ(check_constrained_delaunay(kite.points, kite.triangles, rim).size(), 1U);
  EXPECT_NE(lines(check_angles(kite.points, kite.triangles, rim, 25)), "");
}

}  // namespace
}  // namespace tetropolis
