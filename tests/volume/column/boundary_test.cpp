#include "tetropolis/volume/column/boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"
#include "tetropolis/core/error.h"

#include "check/check_same_boundary.h"
#include "support/errors.h"
#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "volume/column/fill_columns.h"
#include "volume/column/ground_heights.h"

namespace tetropolis {
namespace {

TEST(Boundary, IsExactlyTheFacesOfOneCellAndPassesEveryCheck) {
  const auto result = testing::meshed(testing::small_city(testing::hills));
  const SurfaceMesh surface = extract_boundary(result.mesh);
  const SurfaceTopology topology = check_topology(surface);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.manifold());

  auto lists = testing::explicit_mesh(result.mesh);
  const TetMesh mesh{std::move(lists.points), std::move(lists.cells), {}};
  const VolumeCheck volume = check_volume(mesh);
  EXPECT_TRUE(volume.violations.empty()) << volume.violations[0].what;
  const auto differences = check_same_boundary(mesh, volume, surface);
  EXPECT_TRUE(differences.empty()) << differences[0].first;
  const SurfaceCheck check = check_surface(surface);
  EXPECT_TRUE(check.violations.empty()) << check.violations[0].what << check.violations[0].first;
  EXPECT_NEAR(check.enclosed_volume, volume.volume, 1e-9 * volume.volume);
  for (const auto& [name, faces] : check.faces_by_patch) EXPECT_GT(faces, 0) << name;
  EXPECT_EQ(count_by_patch(surface), check.faces_by_patch);
  EXPECT_TRUE(std::is_sorted(surface.patch.begin(), surface.patch.end()));
}

TEST(Boundary, KnowsItsNodesAndTheCellsBehind) {
  const auto result = testing::meshed(testing::small_city(testing::hills));
  const auto lists = testing::explicit_mesh(result.mesh);
  const SurfaceMesh surface = extract_boundary(result.mesh);
  ASSERT_EQ(surface.node.size(), surface.points.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    ASSERT_EQ(lists.points[static_cast<std::size_t>(surface.node[i])], surface.points[i]);
  ASSERT_EQ(surface.cell.size(), surface.triangles.size());
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& cell = lists.cells[static_cast<std::size_t>(surface.cell[f])];
    for (const std::int32_t p : surface.triangles[f])
      ASSERT_EQ(std::count(cell.begin(), cell.end(), surface.node[static_cast<std::size_t>(p)]), 1);
  }
}

TEST(Boundary, EveryBuildingHasRoofAndWallsOfItsOwn) {
  const auto result = testing::meshed(testing::small_city(testing::hills));
  const SurfaceMesh surface = extract_boundary(result.mesh);
  for (std::size_t b = 0; b < result.city.footprints.size(); ++b) {
    double roof = 0;
    std::int64_t walls = 0;
    for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
      if (surface.building[f] != BuildingIndex(b)) continue;
      if (surface.patch[f] == Patch::kWall) ++walls;
      if (surface.patch[f] != Patch::kRoof) continue;
      const auto& t = surface.triangles[f];
      const auto &p = surface.points[static_cast<std::size_t>(t[0])],
                 &q = surface.points[static_cast<std::size_t>(t[1])],
                 &r = surface.points[static_cast<std::size_t>(t[2])];
      EXPECT_EQ(p[2], result.city.roofs[b]);
      roof -= ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])) / 2;  // faces down
    }
    EXPECT_GT(walls, 0);
    double footprint = 0;
    for (const Ring* ring : [&] {
           std::vector<const Ring*> rings{&result.city.footprints[b].outer};
           for (const Ring& hole : result.city.footprints[b].holes) rings.push_back(&hole);
           return rings;
         }())
      for (std::size_t i = 0; i < ring->size(); ++i) {
        const Point2 u = (*ring)[i], v = (*ring)[(i + 1) % ring->size()];
        footprint += (u.x * v.y - v.x * u.y) / 2;
      }
    EXPECT_NEAR(roof, footprint, 1e-6);
  }
}

/// A grid of squares of 4 m on a slope. The letters are building parts (`roofs`: elevations), the
/// dots open ground. Rows go south.
struct PartyWalls {
  ColumnMesh mesh;
  ColumnPlan plan;

  PartyWalls(const std::vector<std::string>& rows, std::vector<double> roofs) {
    GroundMesh ground;
    ground.regions = testing::regions_of_buildings(roofs.size());
    const std::size_t nx = rows[0].size(), ny = rows.size();
    for (std::size_t j = 0; j <= ny; ++j)
      for (std::size_t i = 0; i <= nx; ++i)
        ground.vertices.push_back({4 * static_cast<double>(i), 4 * static_cast<double>(ny - j)});
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i) {
        const char letter = rows[j][i];
        const VertexIndex north(j * (nx + 1) + i), south = north + nx + 1;
        ground.triangles.insert(ground.triangles.end(),
                                {{south, south + 1, north + 1}, {south, north + 1, north}});
        ground.region.insert(
            ground.region.end(), 2,
            RegionIndex(letter == '.' ? static_cast<int>(roofs.size()) : letter - 'A'));
      }
    for (const Point2 p : ground.vertices) plan.ground.push_back(0.2 * p.x - 0.1 * p.y);
    plan.roofs = std::move(roofs);
    plan.lowest_roof = lowest_roofs(ground, plan.roofs);
    plan.top.assign(ground.vertices.size(), 40);
    plan.spacing = column_spacing(ground);
    plan.rise = ground_rise(ground, plan.ground);
    EdgeGraph edges = build_edge_graph(ground);
    ground.sides = {Patch::kYMin, Patch::kXMax, Patch::kYMax, Patch::kXMin};
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (edges.triangles[e][1] != kNoTriangle) continue;
      const auto [a, b] = edges.vertices[e];
      const Point2 p = ground.vertices[static_cast<std::size_t>(a)];
      const Point2 q = ground.vertices[static_cast<std::size_t>(b)];
      const std::int32_t side = p.x != q.x ? (p.y == 0 ? 0 : 2) : (p.x == 0 ? 3 : 1);
      ground.tagged_edges.push_back({a, b, kNoRegion, side});
    }
    mesh = divide_columns(std::move(ground), std::move(edges), plan);
    place_nodes(mesh, plan);
  }
};

TEST(Boundary, StepsBetweenRoofsThatShareAnEdgeAreWallsOfTheHigherOne) {
  // With corners where two roofs meet the street, where three roofs meet, and a yard.
  const std::vector<std::string> rows{"........", "..AAB...", ".AAABBC.", ".A.ABBC.",
                                      ".AAADDC.", "...DDD..", "........"};
  for (const std::vector<double>& roofs :
       {std::vector{9.0, 14.0, 11.5, 21.0}, std::vector{14.0, 9.0, 9.0, 9.5},
        std::vector{12.0, 12.0, 12.0, 12.0}, std::vector{30.0, 7.25, 30.0, 7.0}}) {
    SCOPED_TRACE(::testing::PrintToString(roofs));
    const PartyWalls city(rows, roofs);
    const ColumnMesh& mesh = city.mesh;
    EXPECT_GT(require_valid(mesh), 0);
    for (const VertexIndex v : mesh.ground.vertices.indices()) {
      EXPECT_EQ(std::ranges::min(mesh.floors_at(v)), 0);
      for (const RegionIndex region : mesh.regions[v])
        EXPECT_EQ(mesh.z[mesh.floor(region, v)], city.plan.floor(mesh.ground, region, v));
    }
    const SurfaceMesh surface = extract_boundary(mesh);
    const SurfaceTopology topology = check_topology(surface);
    EXPECT_TRUE(topology.closed());
    EXPECT_TRUE(topology.manifold()) << topology.non_manifold_edges;
    auto lists = testing::explicit_mesh(mesh);
    const TetMesh tets{std::move(lists.points), std::move(lists.cells), {}};
    const auto differences = check_same_boundary(tets, check_volume(tets), surface);
    EXPECT_TRUE(differences.empty()) << differences[0].first;
    // The walls of each part, in square metres: down to the ground beside it, or to a lower roof.
    std::vector<double> walls(roofs.size(), 0), expected(roofs.size(), 0);
    for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
      if (surface.patch[f] != Patch::kWall) continue;
      std::array<Point3, 3> p;
      for (std::size_t i = 0; i < 3; ++i)
        p[i] = surface.points[static_cast<std::size_t>(surface.triangles[f][i])];
      const double x1 = std::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]);
      const double along =
          (p[1][0] - p[0][0]) * (p[2][0] - p[0][0]) + (p[1][1] - p[0][1]) * (p[2][1] - p[0][1]);
      const double x2 = x1 > 0 ? along / x1 : std::hypot(p[2][0] - p[0][0], p[2][1] - p[0][1]);
      walls[static_cast<std::size_t>(surface.building[f])] +=
          std::abs(x1 * (p[2][2] - p[0][2]) - x2 * (p[1][2] - p[0][2])) / 2;
    }
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
      const auto [t0, t1] = mesh.edges.triangles[e];
      if (t1 == kNoTriangle) continue;
      const RegionIndex r0 = mesh.ground.region[t0], r1 = mesh.ground.region[t1];
      double step = 0;
      for (const VertexIndex v : mesh.edges.vertices[e])
        step += (city.plan.floor(mesh.ground, r0, v) - city.plan.floor(mesh.ground, r1, v)) / 2;
      if (step != 0) expected[step > 0 ? r0 : r1] += 4 * std::abs(step);
    }
    for (std::size_t b = 0; b < roofs.size(); ++b) EXPECT_NEAR(walls[b], expected[b], 1e-9) << b;
  }
}

TEST(Boundary, SelectsPatches) {
  const auto result = testing::meshed(testing::small_city(testing::hills));
  const SurfaceMesh surface = extract_boundary(result.mesh);
  const std::array wanted{Patch::kRoof, Patch::kWall};
  const SurfaceMesh part = select_patches(surface, wanted);
  const auto all = count_by_patch(surface), some = count_by_patch(part);
  EXPECT_EQ(some[1], all[1]);
  EXPECT_EQ(some[2], all[2]);
  ASSERT_EQ(part.triangles.size(), static_cast<std::size_t>(all[1].faces + all[2].faces));
  // The same faces in the same order, with the same corners.
  std::size_t next = 0;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (surface.patch[f] != Patch::kRoof && surface.patch[f] != Patch::kWall) continue;
    EXPECT_EQ(part.patch[next], surface.patch[f]);
    EXPECT_EQ(part.building[next], surface.building[f]);
    EXPECT_EQ(part.cell[next], surface.cell[f]);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(part.triangles[next][i]);
      const auto w = static_cast<std::size_t>(surface.triangles[f][i]);
      EXPECT_EQ(part.points.at(v), surface.points[w]);
      EXPECT_EQ(part.node.at(v), surface.node[w]);
    }
    ++next;
  }
  std::vector<char> used(part.points.size(), 0);
  for (const auto& t : part.triangles)
    for (const std::int32_t v : t) used[static_cast<std::size_t>(v)] = 1;
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
}

TEST(Boundary, RefusesARimThatIsNotTagged) {
  ColumnMesh mesh = testing::meshed(testing::small_city(testing::hills)).mesh;
  EXPECT_NO_THROW(extract_boundary(mesh));
  std::vector<TaggedEdge>& edges = mesh.ground.tagged_edges;
  const auto on_rim = std::find_if(edges.begin(), edges.end(),
                                   [](const TaggedEdge& edge) { return edge.region == kNoRegion; });
  const TaggedEdge edge = *on_rim;
  on_rim->region = RegionIndex(0);
  EXPECT_THROW(extract_boundary(mesh), Error);
  edges.erase(on_rim);
  const std::string message = testing::error_of([&] { extract_boundary(mesh); });
  EXPECT_NE(message.find(std::to_string(edge.low) + " and " + std::to_string(edge.high)),
            std::string::npos)
      << message;
}

TEST(Boundary, CountsBrokenEdges) {
  SurfaceMesh surface;
  surface.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_TRUE(check_topology(surface).closed() && check_topology(surface).manifold());
  auto turned = surface;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_EQ(check_topology(turned).misoriented_edges, 3);
  auto open = surface;
  open.triangles.pop_back();
  EXPECT_EQ(check_topology(open).open_edges, 3);
  auto doubled = surface;
  doubled.triangles.push_back({0, 2, 1});
  EXPECT_EQ(check_topology(doubled).non_manifold_edges, 3);
}

}  // namespace
}  // namespace tetropolis
