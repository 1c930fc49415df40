#include "tetropolis/ground/refine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "tetropolis/core/error.h"

#include "core/units.h"
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

Triangulation expect_refined(const PlanarGraph& graph, const RefineOptions& options,
                             const std::string& name) {
  Triangulation t = refine(graph, options);
  EXPECT_EQ(lines(validate(graph, options, t)), "") << name << ", seed " << testing::test_seed();
  if (t.small_input_angles == 0) {
    EXPECT_EQ(t.triangles_below_min_angle, 0) << name << ", seed " << testing::test_seed();
  }
  return t;
}

TEST(Refine, KeepsTheSegmentsOfCollinearPoints) {
  PlanarGraph graph;
  graph.points = {{0, 0}, {1, 0}, {2, 0}};
  graph.segments = {{VertexIndex(0), VertexIndex(1)}, {VertexIndex(1), VertexIndex(2)}};
  const Triangulation result = refine(graph, {});
  EXPECT_TRUE(result.triangles.empty());
  EXPECT_EQ(result.segments.size(), 2U);
}

TEST(Refine, SquareBecomesAsFineAndAsRegularAsAsked) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 100, 100));
  for (const double angle : {0.0, 20.0, 25.0, 30.0})
    for (const double size : {0.0, 200.0, 30.0, 10.0, 1.5})
      for (const bool lattice : {false, true})
        expect_refined(graph, {.min_angle_deg = angle, .max_edge = size, .lattice = lattice},
                       std::to_string(angle) + " " + std::to_string(size));
}

TEST(Refine, RandomPointsAndSegmentsThatDoNotMeetSharply) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    PlanarGraph graph;
    add_ring(graph, rectangle_ring(0, 0, 20, 20));
    const int n = random.integer(1, 30);
    for (int k = 0; k < n; ++k) graph.points.push_back({random.real(1, 19), random.real(1, 19)});
    const Polygon tilted = testing::random_rectangles(1, 40, 1, random)[0];
    std::vector<Point2> ring;
    for (const Point2 p : tilted.outer) ring.push_back({2 + 0.4 * p.x, 2 + 0.4 * p.y});
    if (i % 2 == 0) add_ring(graph, ring);
    const double angle = i % 3 == 0 ? 20 : i % 3 == 1 ? 25 : 30;
    const double size = i % 4 == 0 ? 1.5 : 0;
    expect_refined(graph, {.min_angle_deg = angle, .max_edge = size}, "case " + std::to_string(i));
  }
}

// Anything goes: crossings at any angle, tiny gaps. The exceptions must be at sharp corners.
TEST(Refine, RandomSegmentsThatCrossAtAnyAngle) {
  Random random(12);
  for (int i = 0; i < 300; ++i) {
    PlanarGraph graph;
    add_ring(graph, rectangle_ring(-1, -1, 11, 11));
    const int n = random.integer(1, 6);
    for (int k = 0; k < n; ++k) {
      const auto first = VertexIndex(graph.points.size());
      graph.points.push_back(i % 2 == 0 ? random.grid_point(10) : random.point(10));
      graph.points.push_back(i % 2 == 0 ? random.grid_point(10) : random.point(10));
      graph.segments.push_back({first, first + 1});
    }
    const double angle = i % 3 == 0 ? 20 : i % 3 == 1 ? 25 : 30;
    expect_refined(graph, {.min_angle_deg = angle, .max_edge = i % 5 == 0 ? 1.0 : 0},
                   "case " + std::to_string(i));
  }
}

TEST(Refine, CornersSharperThanTheBoundAreCountedAndRefinementEnds) {
  for (const double corner :
       {0.01, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 19.0, 24.0, 26.0, 35.0, 45.0, 59.0}) {
    for (const double angle : {20.0, 25.0, 30.0}) {
      for (const double size : {0.0, 1.0}) {
        PlanarGraph graph;
        const double a = corner * std::numbers::pi / 180;
        graph.points = {{0, 0},     {10, 0},   {7 * std::cos(a), 7 * std::sin(a)},
                        {-10, -10}, {20, -10}, {20, 20},
                        {-10, 20}};
        graph.segments = edges_of({{0, 1}, {0, 2}, {3, 4}, {4, 5}, {5, 6}, {6, 3}});
        const RefineOptions options{.min_angle_deg = angle, .max_edge = size};
        expect_refined(graph, options, std::to_string(corner) + " " + std::to_string(angle));
        const Triangulation t = refine(graph, options);
        EXPECT_EQ(t.small_input_angles, corner < angle ? 1 : 0);
        EXPECT_EQ(t.triangles_below_min_angle > 0, corner < angle);
      }
    }
  }
}

/// Between the first shell and the far side of a narrow triangle there is room for angles nearly as
/// large as that of its tip.
// Told without the validator: no triangle of a needle and its surroundings is sharper than it.
TEST(Refine, AcrossFromASharpCornerNoAngleIsSharper) {
  for (const double least : {25.0, 30.0})
    for (const double corner : {2.0, 8.0, 13.0, 13.5, 16.0, 20.0, 24.0, 26.0, 29.5})
      for (const double leg : {5.9, 7.0, 9.13, 11.5})
        for (const double other : {1.0, 0.8, 0.5}) {
          PlanarGraph graph;
          const double a = corner * std::numbers::pi / 180;
          add_ring(graph,
                   {{0, 0}, {leg, 0}, {other * leg * std::cos(a), other * leg * std::sin(a)}});
          add_ring(graph, rectangle_ring(-20, -20, 30, 30));
          const RefineOptions options{.min_angle_deg = least, .max_edge = 10};
          const std::string name = std::to_string(corner) + " " + std::to_string(leg);
          const Triangulation mesh = expect_refined(graph, options, name);
          // The end of the longer leg may be the sharpest corner.
          const double end = std::atan(other * std::sin(a) / (1 - other * std::cos(a)));
          EXPECT_GE(angle_statistics(mesh.points, mesh.triangles).min_deg,
                    std::min({corner, end * 180 / std::numbers::pi, least}) - 0.05)
              << name;
        }
}

TEST(Refine, FansOfSharpCorners) {
  for (const int blades : {3, 12, 60, 360}) {
    PlanarGraph graph;
    add_ring(graph, rectangle_ring(-10, -10, 10, 10));
    graph.points.push_back({0.5, 0.25});
    const auto hub = VertexIndex(graph.points.size()) - 1;
    for (int k = 0; k < blades; ++k) {
      const double a = 2 * std::numbers::pi * k / blades, r = 3 + 4.0 * ((k * 7) % 5) / 5;
      graph.points.push_back({0.5 + r * std::cos(a), 0.25 + r * std::sin(a)});
      graph.segments.push_back({hub, hub + 1 + k});
    }
    for (const double size : {0.0, 2.0})
      expect_refined(graph, {.min_angle_deg = 25, .max_edge = size}, std::to_string(blades));
  }
}

TEST(Refine, NarrowGapsAndAlmostParallelSegments) {
  for (const double gap : {1.0, 0.1, 0.01, 0.003}) {
    for (const double offset : {0.0, 6.4e6}) {
      PlanarGraph graph;
      add_ring(graph, rectangle_ring(offset, offset, offset + 10, offset + 10));
      add_ring(graph, rectangle_ring(offset + 2, offset + 2, offset + 8, offset + 4));
      std::vector<Point2> tilted =
          rectangle_ring(offset + 2, offset + 4 + gap, offset + 8, offset + 7);
      tilted[1].y += 0.3 * gap;
      add_ring(graph, tilted);
      expect_refined(graph, {.min_angle_deg = 25, .max_edge = 2}, std::to_string(gap));
    }
  }
}

TEST(Refine, SegmentsInNoRelationToTheDomain) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 10, 10));
  graph.points.insert(graph.points.end(),
                      {{3, 3}, {7, 3}, {5, 5}, {5, 9}, {2, 0}, {2, 4}, {8, 8}, {8, 8}});
  for (const auto& segment : edges_of({{4, 5}, {6, 7}, {8, 9}, {10, 11}, {6, 6}}))
    graph.segments.push_back(segment);
  expect_refined(graph, {.min_angle_deg = 30, .max_edge = 1}, "dangling");
}

TEST(Refine, SizeOfRegionsAndSizeField) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 40, 40));
  add_ring(graph, rectangle_ring(10, 10, 20, 20));
  graph.regions = {{{15, 15}, 3, 1.0}};
  RefineOptions options{.min_angle_deg = 25, .max_edge = 6};
  expect_refined(graph, options, "region");
  const auto check = [&](const Triangulation& t, const auto& bound) {
    for (std::size_t i = 0; i < t.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Point2 p = t.points[static_cast<std::size_t>(t.triangles[i][k])];
        const Point2 q = t.points[static_cast<std::size_t>(t.triangles[i][(k + 1) % 3])];
        EXPECT_LE(std::hypot(p.x - q.x, p.y - q.y),
                  bound(t.triangle_regions[i], {0.5 * (p.x + q.x), 0.5 * (p.y + q.y)}) + 1e-12);
      }
    }
  };
  const Triangulation fine = refine(graph, options);
  check(fine, [](std::int32_t region, Point2) { return region == 3 ? 1.0 : 6.0; });
  EXPECT_GT(std::count(fine.triangle_regions.begin(), fine.triangle_regions.end(), 3), 200);
  options.size_field = [](Point2 p) { return 0.5 + 0.1 * std::hypot(p.x - 15, p.y - 15); };
  expect_refined(graph, options, "field");
  check(refine(graph, options), [&](std::int32_t region, Point2 p) {
    return std::min(region == 3 ? 1.0 : 6.0, options.size_field(p));
  });
}

TEST(Refine, EdgesAtSegmentsWithABoundOfTheirOwn) {
  Random random(16);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    PlanarGraph graph;
    add_ring(graph, rectangle_ring(0, 0, 100, 100));
    for (const Polygon& p : testing::random_rectangles(6, 100, 1, random)) add_ring(graph, p.outer);
    for (std::size_t s = 0; s < graph.segments.size(); ++s)
      graph.segment_max_edge.push_back(s >= 4 && random.integer(0, 2) == 0
                                           ? random.real(0.7, 20)
                                           : std::numeric_limits<double>::infinity());
    const double size = i % 3 == 0 ? 0 : i % 3 == 1 ? 12 : 30;
    const RefineOptions options{
        .min_angle_deg = 25, .max_edge = size, .lattice = i % 2 == 0, .optimize = i % 5 != 0};
    expect_refined(graph, options, "bounds of segments");
    const Triangulation t = refine(graph, options);
    std::vector<double> bound(t.points.size(), size > 0 ? size : 1e9);
    for (std::size_t s = 0; s < t.segments.size(); ++s)
      for (const VertexIndex v : t.segments[s]) {
        double& own = bound[static_cast<std::size_t>(v)];
        own = std::min(own, graph.segment_max_edge[static_cast<std::size_t>(t.segment_inputs[s])]);
      }
    for (const auto& triangle : t.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = static_cast<std::size_t>(triangle[k]);
        const auto b = static_cast<std::size_t>(triangle[(k + 1) % 3]);
        const double length =
            std::hypot(t.points[a].x - t.points[b].x, t.points[a].y - t.points[b].y);
        EXPECT_LE(length, std::min(bound[a], bound[b]) + 1e-9) << "seed " << testing::test_seed();
      }
  }
}

// Segments that are cut where they cross, or nearly end on one another, leave dead ones behind.
TEST(Refine, BoundsOfSegmentsThatCross) {
  Random random(17);
  int refused = 0;
  for (int i = 0; i < 100; ++i) {
    PlanarGraph graph;
    add_ring(graph, rectangle_ring(-10, -10, 110, 110));
    graph.segment_max_edge.assign(4, 50);
    const auto add = [&](Point2 a, Point2 b) {
      const auto n = VertexIndex(graph.points.size());
      graph.points.insert(graph.points.end(), {a, b});
      graph.segments.push_back({n, n + 1});
      graph.segment_max_edge.push_back(20);
    };
    const auto anywhere = [&] { return Point2{random.real(0, 100), random.real(0, 100)}; };
    for (int k = 0; k < 6; ++k) {
      const Point2 a = anywhere(), b = anywhere();
      add(a, b);
      const double t = random.real(0, 1);
      const double off = 100 * 0x1p-46 * (i % 7 - 3);
      add(anywhere(), {a.x + t * (b.x - a.x) + off, a.y + t * (b.y - a.y)});
    }
    Triangulation t;
    try {
      t = refine(graph, {.min_angle_deg = 20, .max_edge = 50, .max_vertices = 200'000});
    } catch (const Error& error) {  // Lines a picometre apart may take millions.
      EXPECT_NE(std::string(error.what()).find("more than 200000 vertices"), std::string::npos);
      ++refused;
      continue;
    }
    // Of angles nothing is promised where input is finer than its coordinates.
    EXPECT_EQ(lines(validate(graph, {.min_angle_deg = 0, .max_edge = 50}, t)), "")
        << i << ", seed " << testing::test_seed();
  }
  EXPECT_LE(refused, 2);
}

TEST(Refine, HolesStayEmptyAndTheirSidesAreKept) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 30, 30));
  add_ring(graph, {{10, 10}, {20, 12}, {12, 20}});
  graph.holes = {{13, 13}};
  const RefineOptions options{.min_angle_deg = 30, .max_edge = 3};
  expect_refined(graph, options, "hole");
  double covered = 0;
  const Triangulation t = refine(graph, options);
  for (const auto& v : t.triangles) {
    const auto at = [&](std::size_t i) { return t.points[static_cast<std::size_t>(v[i])]; };
    covered += 0.5 * ((at(1).x - at(0).x) * (at(2).y - at(0).y) -
                      (at(1).y - at(0).y) * (at(2).x - at(0).x));
  }
  EXPECT_NEAR(covered, 900 - 48, 1e-9);
}

// Cuts of a turned side are off its line by rounding, and the hull between them is as thin.
TEST(Refine, SidesOfATurnedSquareAreCutEvenly) {
  for (const double degrees : {0.0, 10.0, 45.0, 60.0}) {
    SCOPED_TRACE(degrees);
    PlanarGraph graph;
    const double radius = 2000;
    for (int i = 0; i < 4; ++i) {
      const double angle = to_radians(degrees + 90 * i);
      graph.points.push_back({std::round(1e3 * (150.567 + radius * std::cos(angle))) / 1e3,
                              std::round(1e3 * (-1503.4 + radius * std::sin(angle))) / 1e3});
      graph.segments.push_back({VertexIndex(i), VertexIndex((i + 1) % 4)});
    }
    const double size = 10;
    const Triangulation mesh = refine(graph, {.max_edge = size});
    const double cuts = std::ceil(radius * std::numbers::sqrt2 / size);
    // Some more where the lattice is near.
    EXPECT_GE(static_cast<double>(mesh.segments.size()), 4 * cuts);
    EXPECT_LT(static_cast<double>(mesh.segments.size()), 1.15 * 4 * cuts);
  }
}

TEST(Refine, LatticeNeedsFewerAndBetterTriangles) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 500, 500));
  const Triangulation with = refine(graph, {.max_edge = 10});
  const Triangulation without = refine(graph, {.max_edge = 10, .lattice = false});
  EXPECT_LT(1.3 * static_cast<double>(with.triangles.size()),
            static_cast<double>(without.triangles.size()));
  EXPECT_GT(angle_statistics(with.points, with.triangles).mean_min_deg,
            angle_statistics(without.points, without.triangles).mean_min_deg + 5);
}

TEST(Refine, RealGraphs) {
  TETROPOLIS_REQUIRE_DATA(folder, "stockholm_case55_pslg");
  std::map<std::string, PlanarGraph> graphs;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".pslg")
      graphs[entry.path().filename().string()] = testing::read_pslg(entry.path());
  EXPECT_GE(graphs.size(), 89U);
  for (const auto& [name, graph] : graphs) {
    const bool city = name.rfind("ground", 0) == 0 || name.rfind("building", 0) == 0;
    for (const double angle : {20.0, 25.0, 30.0})
      expect_refined(graph, {.min_angle_deg = angle, .max_edge = city ? 10.0 : 0}, name);
  }
}

TEST(Refine, TrianglesOnCliffsBecomeLessSteep) {
  // A rock wall of 20 m that winds past a building.
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 150, 100));
  const auto first = graph.segments.size();
  add_ring(graph, rectangle_ring(62, 30, 78, 44));
  for (std::size_t s = first; s < graph.segments.size(); ++s) {
    graph.segment_sides.resize(graph.segments.size(), {kUnmarkedSide, kUnmarkedSide});
    graph.segment_sides[s] = {0, -1};
  }
  const auto cliff = [](Point2 p) {
    return std::clamp(20 * (p.x - 50 - 6 * std::sin(p.y / 9)), 0.0, 20.0);
  };
  const auto steep = [&](const Triangulation& t, double degrees) {
    int count = 0;
    for (std::size_t k = 0; k < t.triangles.size(); ++k) {
      if (t.triangle_regions[k] >= 0) continue;
      const Point2 a = t.points[static_cast<std::size_t>(t.triangles[k][0])];
      const Point2 b = t.points[static_cast<std::size_t>(t.triangles[k][1])];
      const Point2 c = t.points[static_cast<std::size_t>(t.triangles[k][2])];
      const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      const double zb = cliff(b) - cliff(a), zc = cliff(c) - cliff(a);
      const double gx = (zb * (c.y - a.y) - zc * (b.y - a.y)) / twice;
      const double gy = (zc * (b.x - a.x) - zb * (c.x - a.x)) / twice;
      if (std::hypot(gx, gy) > std::tan(degrees * std::numbers::pi / 180)) ++count;
    }
    return count;
  };
  RefineOptions options{.min_angle_deg = 25, .max_edge = 5};
  const Triangulation plain = refine(graph, options);
  options.elevation = cliff;
  const Triangulation moved = refine(graph, options);
  EXPECT_EQ(lines(validate(graph, options, moved)), "");
  EXPECT_EQ(moved.triangles, plain.triangles);  // nothing but positions
  EXPECT_GT(steep(plain, 79), 20);
  EXPECT_LT(10 * steep(moved, 79), steep(plain, 79));
  for (std::size_t k = 0; k < plain.triangles.size(); ++k)
    for (const VertexIndex v : plain.triangles[k]) {
      const Point2 p = plain.points[static_cast<std::size_t>(v)];
      const Point2 q = moved.points[static_cast<std::size_t>(v)];
      const bool away = p.x < 35 || p.x > 66;
      if (away || plain.triangle_regions[k] >= 0) {
        EXPECT_EQ(p.x, q.x);
        EXPECT_EQ(p.y, q.y);
      }
    }
  options.elevation = [](Point2 p) { return 2 * p.x; };
  EXPECT_EQ(refine(graph, options).points, plain.points) << "63 degrees are not steep";
}

TEST(Refine, GivesTheSameBytesTwice) {
  Random random(13);
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 300, 300));
  for (const Polygon& p : testing::random_rectangles(40, 300, 1, random)) add_ring(graph, p.outer);
  const RefineOptions options{.min_angle_deg = 25, .max_edge = 7};
  const Triangulation first = refine(graph, options);
  const Triangulation second = refine(graph, options);
  EXPECT_EQ(first.points, second.points);
  EXPECT_EQ(first.triangles, second.triangles);
  EXPECT_EQ(first.segments, second.segments);
}

TEST(Refine, GivesUpWithAPositionInsteadOfRunningOn) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 100, 100));
  try {
    refine(graph, {.max_edge = 1, .max_vertices = 500});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kGuarantee);
    EXPECT_NE(std::string(e.what()).find("500 vertices"), std::string::npos);
  }
  for (const RefineOptions& bad :
       {RefineOptions{.min_angle_deg = 40}, RefineOptions{.max_edge = -1},
        RefineOptions{.max_edge = std::nan("")}})
    EXPECT_THROW(refine(graph, bad), Error);
}

TEST(Refine, ReportsProgressAndStopsWhenAsked) {
  PlanarGraph graph;
  add_ring(graph, rectangle_ring(0, 0, 100, 100));
  // With the lattice there are several patches of triangles from the start, without it there is
  // one.
  for (const bool lattice : {false, true}) {
    SCOPED_TRACE(lattice);
    const RefineOptions options{.max_edge = lattice ? 0.7 : 1, .lattice = lattice};
    Progress progress;
    double last = 0;
    progress.report = [&](double fraction) {
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1);
      EXPECT_LT(fraction, last + 0.35);
      last = fraction;
    };
    int polls = 0;
    progress.cancelled = [&] { return ++polls, false; };
    EXPECT_GT(refine(graph, options, progress).triangles.size(), 20'000U);
    EXPECT_EQ(last, 1);
    for (int allowed = 0; allowed < polls; ++allowed) {
      int calls = 0;
      Progress impatient;
      impatient.cancelled = [&] { return ++calls > allowed; };
      EXPECT_THROW(refine(graph, options, impatient), Cancelled);
      EXPECT_EQ(calls, allowed + 1);
    }
  }
}

}  // namespace
}  // namespace tetropolis
