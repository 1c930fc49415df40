#include "tetropolis/ground/mesh_ground.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

#include "ground_cases.h"

namespace tetropolis {
namespace {

using testing::lines;
using testing::Random;

GroundMesh expect_valid(const std::vector<Polygon>& footprints, const Bounds2& domain,
                        const GroundMeshOptions& options = {}) {
  GroundMesh mesh = mesh_ground(footprints, domain, options);
  EXPECT_EQ(lines(validate(mesh, footprints, domain, options)), "")
      << "seed " << testing::test_seed();
  return mesh;
}

TEST(MeshGround, RandomRectangles) {
  Random random(21);
  for (const int count : {0, 1, 5, 50, 400}) {
    for (const double clearance : {5.0, 1.0, 0.2}) {
      for (const double size : {10.0, 4.0}) {
        const double side = 60 + 30 * std::sqrt(count);
        const auto city = testing::random_rectangles(count, side, clearance, random);
        const double angle = size == 4 ? 30 : 25;
        const GroundMesh mesh = expect_valid(city, {0, 0, side, side}, {size, angle});
        EXPECT_EQ(mesh.small_input_angles, 0);
        EXPECT_EQ(mesh.triangles_below_min_angle, 0);
      }
    }
  }
}

TEST(MeshGround, CourtyardsAndAnyOrientation) {
  Polygon block;
  block.outer = {{20, 20}, {20, 60}, {60, 60}, {60, 20}};             // clockwise
  block.holes = {{{30, 30}, {50, 30}, {50, 50}, {30, 50}}};           // counter-clockwise
  const Polygon inner{{{35, 35}, {45, 35}, {45, 45}, {35, 45}}, {}};  // a building in the courtyard
  const std::vector<Polygon> city = {block, inner};
  const GroundMesh mesh = expect_valid(city, {0, 0, 80, 80});
  for (const TriangleIndex t : mesh.triangles.indices()) {
    Point2 c;
    for (const VertexIndex v : mesh.triangles[t]) {
      c.x += mesh.vertices[static_cast<std::size_t>(v)].x / 3;
      c.y += mesh.vertices[static_cast<std::size_t>(v)].y / 3;
    }
    const BuildingIndex expected = contains(inner, c)   ? BuildingIndex(1)
                                   : contains(block, c) ? BuildingIndex(0)
                                                        : kNoBuilding;
    EXPECT_EQ(mesh.region_of(t).building, expected);
    EXPECT_EQ(mesh.inside_building(t), expected != kNoBuilding);
  }
}

TEST(MeshGround, WallsWithABoundOfTheirOwn) {
  Random random(25);
  auto city = testing::random_rectangles(12, 150, 1, random);
  city.push_back({{{-60, 20}, {-20, 20}, {-20, 60}, {-60, 60}},
                  {{{-50, 30}, {-50, 50}, {-30, 50}, {-30, 30}}}});
  const Bounds2 domain{-80, 0, 150, 150};
  GroundMeshOptions options{12, 25};
  // Differs between buildings, and between the walls of one.
  options.wall_edge = [](RegionIndex building, Point2 a, Point2 b) {
    return 0.8 + 3 * (building.value() % 4) + (a.x == b.x ? 1.5 : 0);
  };
  const GroundMesh mesh = expect_valid(city, domain, options);
  EXPECT_GT(mesh.triangles.size(), 2 * expect_valid(city, domain, {12, 25}).triangles.size());
  GroundMeshOptions stricter = options;
  stricter.wall_edge = [&](RegionIndex building, Point2 a, Point2 b) {
    return (building == 12 ? 0.5 : 1) * options.wall_edge(building, a, b);
  };
  EXPECT_NE(lines(validate(mesh, city, domain, stricter)).find("at a segment that bounds it to"),
            std::string::npos);
}

TEST(MeshGround, FarCoordinatesAndSidesThatAreNoRoundNumbers) {
  Random random(22);
  auto city = testing::random_rectangles(30, 200, 1, random);
  const Point2 shift{674999.123456, 6400000.98765};
  for (Polygon& p : city)
    for (Point2& q : p.outer) q = {q.x + shift.x, q.y + shift.y};
  const Bounds2 domain{shift.x - 0.1, shift.y - 1.0 / 3, shift.x + 200.7, shift.y + 200 + 1.0 / 7};
  expect_valid(city, domain, {7.3, 28});
}

TEST(MeshGround, BuildingsCloseToTheDomainBoundaryAndToEachOther) {
  const std::vector<Polygon> city = {{{{1, 1}, {30, 1}, {30, 20}, {1, 20}}, {}},
                                     {{{31, 1}, {60, 1}, {60, 20}, {31, 20}}, {}},
                                     {{{1, 21}, {60, 21.5}, {60, 50}, {1, 50}}, {}},
                                     {{{70, 5}, {99.9, 5}, {99.9, 5.5}, {70, 6}}, {}}};
  expect_valid(city, {0, 0, 100, 60}, {10, 25});
  expect_valid(city, {0, 0, 100, 60}, {10, 30});
}

TEST(MeshGround, SharpCornersOfFootprintsAreCounted) {
  const std::vector<Polygon> city = {{{{10, 10}, {60, 10}, {60, 14}}, {}},
                                     {{{10, 40}, {50, 40}, {12, 60}}, {}}};
  const GroundMesh mesh = expect_valid(city, {0, 0, 70, 70}, {10, 25});
  EXPECT_EQ(mesh.small_input_angles, 1);
  std::int64_t below = 0;
  for (const auto& t : mesh.triangles)
    if (angle_statistics(mesh.vertices, {&t, 1}).min_deg < 25) ++below;
  EXPECT_GT(below, 0);
  EXPECT_EQ(mesh.triangles_below_min_angle, below);
}

TEST(MeshGround, LongThinDomainsAndDomainsSmallerThanTheMeshSize) {
  expect_valid({}, {0, 0, 1000, 3}, {10, 25});
  expect_valid({}, {0, 0, 1, 1}, {10, 25});
  expect_valid({}, {-5, -5, 5.5, 4}, {10, 25});
  expect_valid({{{{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}}, {}}}, {0, 0, 1, 1}, {10, 25});
}

TEST(MeshGround, NumbersNeighboursNearEachOther) {
  Random random(23);
  const auto city = testing::random_rectangles(200, 700, 2, random);
  const GroundMesh mesh = mesh_ground(city, {0, 0, 700, 700});
  double total = 0;
  for (const auto& t : mesh.triangles)
    total += std::abs(t[0] - t[1]) + std::abs(t[1] - t[2]) + std::abs(t[2] - t[0]);
  const double mean = total / (3.0 * static_cast<double>(mesh.triangles.size()));
  // Row by row the mean would be about the square root of the number of vertices, unordered a
  // third.
  EXPECT_LT(mean, 0.05 * static_cast<double>(mesh.vertices.size()));
}

TEST(MeshGround, GivesTheSameBytesWithOneAndWithTwoThreads) {
  Random random(24);
  const auto city = testing::random_rectangles(150, 600, 1, random);
  const auto make = [&](int threads) {
    const ThreadLimit limit(threads);
    return mesh_ground(city, {0, 0, 600, 600}, {6, 25});
  };
  const GroundMesh one = make(1), two = make(2);
  EXPECT_EQ(one.vertices, two.vertices);
  EXPECT_EQ(one.triangles, two.triangles);
  EXPECT_EQ(one.region, two.region);
}

TEST(MeshGround, NamesTheFootprintThatIsOutside) {
  const Bounds2 domain{0, 0, 100, 100};
  const Polygon good{{{10, 10}, {20, 10}, {20, 20}}, {}};
  for (const Point2 bad : {Point2{100, 50}, Point2{-1, 50}, Point2{50, std::nan("")}}) {
    Polygon broken = good;
    broken.outer[1] = bad;
    const std::vector<Polygon> city = {good, broken};
    try {
      mesh_ground(city, domain);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInput);
      EXPECT_NE(std::string(e.what()).find("footprint 1"), std::string::npos);
    }
  }
  EXPECT_THROW(mesh_ground({}, {0, 0, 0, 5}), Error);
  EXPECT_THROW(mesh_ground({}, {0, 0, std::nan(""), 5}), Error);
  EXPECT_THROW(mesh_ground({}, domain, {0, 25}), Error);
  EXPECT_THROW(mesh_ground({}, domain, {10, 50}), Error);
}

TEST(MeshGround, PartsOfABuildingShareTheirLines) {
  // Quads with jittered corners around a yard, and a building of its own beside them.
  Random random(33);
  for (int trial = 0; trial < 20; ++trial) {
    constexpr int kSide = 4;
    std::vector<Point2> corner;
    for (int j = 0; j <= kSide; ++j)
      for (int i = 0; i <= kSide; ++i)
        corner.push_back({20 + 8.0 * i + random.real(-1, 1), 20 + 8.0 * j + random.real(-1, 1)});
    std::vector<Polygon> outlines{rectangle({70, 20, 82, 30})};
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        if (i == 1 && j == 2) continue;
        const auto at = [&](int a, int b) {
          return corner[static_cast<std::size_t>(b * (kSide + 1) + a)];
        };
        Ring ring{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
        if (i == j) std::reverse(ring.begin(), ring.end());
        outlines.push_back({std::move(ring), {}});
      }
    std::vector<PartOutline> parts{{&outlines[0], BuildingIndex(0), 0}};
    for (std::size_t p = 1; p < outlines.size(); ++p)
      parts.push_back({&outlines[p], BuildingIndex(1), static_cast<std::int32_t>(p - 1)});
    GroundMeshOptions options{6, 25};
    constexpr double kShort = 1.5;
    options.party_line = [&](RegionIndex left, RegionIndex right, Point2 a, Point2 b) {
      EXPECT_TRUE(left != right && left > 0 && right > 0);
      const Point2 third{a.x + (b.x - a.x) / 3, a.y + (b.y - a.y) / 3};
      return std::vector<LinePiece>{{third, kShort}, {b, 6}};
    };
    const Bounds2 domain{0, 0, 100, 80};
    const GroundMesh mesh = mesh_ground_parts(parts, domain, options);
    EXPECT_EQ(lines(check_topology(mesh.vertices, mesh.triangles)), "");
    ASSERT_EQ(mesh.regions.size(), outlines.size() + 1);
    EXPECT_EQ(mesh.regions.back(), Region{});
    std::vector<double> covered(mesh.regions.size(), 0);
    std::map<std::pair<VertexIndex, VertexIndex>, std::set<RegionIndex>> sides;
    for (const TriangleIndex t : mesh.triangles.indices()) {
      const auto& v = mesh.triangles[t];
      const Ring ring{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
      covered[mesh.region[t]] += signed_area(ring);
      for (std::size_t i = 0; i < 3; ++i)
        sides[std::minmax({v[i], v[(i + 1) % 3]})].insert(mesh.region[t]);
      // By point in polygon, which part it is.
      const Point2 centre{(ring[0].x + ring[1].x + ring[2].x) / 3,
                          (ring[0].y + ring[1].y + ring[2].y) / 3};
      RegionIndex part(outlines.size());
      for (const RegionIndex p : indices<RegionIndex>(outlines.size()))
        if (contains(outlines[p], centre)) part = p;
      ASSERT_EQ(mesh.region[t], part);
    }
    for (std::size_t p = 0; p < outlines.size(); ++p) {
      EXPECT_EQ(mesh.regions[RegionIndex(p)].building, parts[p].building);
      EXPECT_EQ(mesh.regions[RegionIndex(p)].part, parts[p].part);
      EXPECT_NEAR(covered[p], area(outlines[p]), 1e-9);
    }
    // Edges between regions, and no others within, are tagged; those beside a third are short.
    std::size_t between = 0;
    for (const auto& side : sides) {
      if (side.second.size() < 2) continue;
      ++between;
      EXPECT_TRUE(std::any_of(
          mesh.tagged_edges.begin(), mesh.tagged_edges.end(), [&](const TaggedEdge& tag) {
            return std::pair(tag.low, tag.high) == side.first && side.second.count(tag.region) > 0;
          }));
    }
    std::size_t on_sides = 0;
    for (const TaggedEdge& tag : mesh.tagged_edges) on_sides += tag.region == kNoRegion ? 1 : 0;
    EXPECT_EQ(mesh.tagged_edges.size(), between + on_sides);
    for (std::size_t p = 1; p < outlines.size(); ++p)
      for (std::size_t q = p + 1; q < outlines.size(); ++q)
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j) {
            const Point2 a = outlines[p].outer[i], b = outlines[p].outer[(i + 1) % 4];
            const Point2 c = outlines[q].outer[j], d = outlines[q].outer[(j + 1) % 4];
            if (!((a == c && b == d) || (a == d && b == c))) continue;
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            std::size_t thirds = 0;
            for (const Point2 v : mesh.vertices)
              for (const double t : {1.0 / 3, 2.0 / 3})
                thirds += std::hypot(v.x - a.x - t * (b.x - a.x), v.y - a.y - t * (b.y - a.y)) <
                                  1e-9 * length
                              ? 1
                              : 0;
            EXPECT_GE(thirds, 1U);
          }
  }
}

TEST(MeshGround, ChecksNoticeDamage) {
  const std::vector<Polygon> city = {{{{20, 20}, {50, 20}, {50, 45}, {20, 45}}, {}}};
  const Bounds2 domain{0, 0, 80, 80};
  const GroundMesh good = mesh_ground(city, domain);
  const auto damaged = [&](auto&& change) {
    GroundMesh bad = good;
    change(bad);
    return !validate(bad, city, domain, {}).empty();
  };
  EXPECT_TRUE(damaged([](GroundMesh& m) { m.region[0] = RegionIndex(0); }));
  EXPECT_TRUE(damaged([](GroundMesh& m) { m.regions.pop_back(); }));
  EXPECT_TRUE(damaged([](GroundMesh& m) { m.tagged_edges.pop_back(); }));
  for (const bool on_side : {false, true})
    EXPECT_TRUE(damaged([&](GroundMesh& m) {
      for (TaggedEdge& edge : m.tagged_edges)
        if ((edge.region == kNoRegion) == on_side) {
          edge.segment = (edge.segment + 1) % 4;
          return;
        }
    }));
  EXPECT_TRUE(damaged([](GroundMesh& m) { m.triangles.pop_back(), m.region.pop_back(); }));
  EXPECT_TRUE(damaged([](GroundMesh& m) { m.vertices.push_back({1, 1}); }));
  EXPECT_TRUE(damaged([](GroundMesh& m) {
    for (Point2& p : m.vertices)
      if (p == Point2{20, 20}) p.x += 1e-9;
  }));
  EXPECT_TRUE(damaged([](GroundMesh& m) {
    for (Point2& p : m.vertices)
      if (p == Point2{80, 80}) p.x += 1e-9;
  }));
  EXPECT_FALSE(damaged([](GroundMesh&) {}));
  EXPECT_FALSE(validate(good, city, domain, {5, 25}).empty());
  EXPECT_FALSE(validate(good, city, domain, {10, 55}).empty());
}

}  // namespace
}  // namespace tetropolis
