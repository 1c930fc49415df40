// Roofs that slope, meet, cross and step, over parts that lie anyhow.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"
#include "tetropolis/volume/column/boundary.h"

#include "check/check_same_boundary.h"
#include "support/explicit_mesh.h"
#include "support/test_data.h"
#include "volume/column/fill_columns.h"
#include "volume/column/ground_heights.h"
#include "volume/column/levels.h"
#include "volume/column/roof_heights.h"
#include "volume/quality/improve_columns.h"

namespace tetropolis {
namespace {

constexpr double kLeastStep = 0.3;  // metres

constexpr double kTop = 300;

/// A grid of `n` squares of 4 m with open ground around; squares of one building have parts at
/// random, each with its plane.
struct SlopedParts {
  std::vector<RoofPlane> planes;
  ReconciledRoofs roofs;
  ColumnMesh mesh;
  ColumnPlan plan;
  std::int64_t closed = 0;

  SlopedParts(int n, int parts, double steepest_deg, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (int p = 0; p < parts; ++p) {
      const double slope = std::tan(unit(random) * steepest_deg / 57.29578);
      const double azimuth = unit(random) * 6.2831853;
      const Point2 centre{4 * n * unit(random), 4 * n * unit(random)};
      planes.push_back(snap_plane(
          {centre, 10 + 15 * unit(random), slope * std::cos(azimuth), slope * std::sin(azimuth)}));
    }
    GroundMesh ground;
    for (int p = 0; p < parts; ++p)
      ground.regions.push_back({RegionKind::kBuildingPart, BuildingIndex(0), p, Patch::kRoof});
    ground.regions.push_back({});
    const auto at = [&](int i, int j) { return VertexIndex(j * (n + 1) + i); };
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        ground.vertices.push_back({4.0 * i + 0.4 * unit(random), 4.0 * j + 0.4 * unit(random)});
    const auto letter = [&](int i, int j) {
      // Blobs: the part whose centre is nearest, now and then another one.
      if (i < 1 || j < 1 || i >= n - 1 || j >= n - 1) return parts;
      if (i == n / 2 && j == n / 2) return parts;  // a yard
      if (unit(random) < 0.05) return static_cast<int>(unit(random) * parts);
      int nearest = 0;
      double least = 1e9;
      for (int p = 0; p < parts; ++p) {
        const double d = std::hypot(planes[static_cast<std::size_t>(p)].at.x - 4 * i,
                                    planes[static_cast<std::size_t>(p)].at.y - 4 * j);
        if (d < least) least = d, nearest = p;
      }
      return nearest;
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const RegionIndex region(letter(i, j));
        ground.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        ground.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        ground.region.push_back(region);
        ground.region.push_back(region);
      }
    // Roofs stay above the ground.
    for (RoofPlane& plane : planes) {
      double low = 1e9;
      for (const TriangleIndex t : ground.triangles.indices())
        if (&plane == &planes[std::min<std::size_t>(ground.region[t], planes.size() - 1)])
          for (const VertexIndex v : ground.triangles[t])
            low = std::min(low, plane(ground.vertices[v]));
      if (low < 5) plane.elevation += std::ceil(5 - low);
    }
    EdgeGraph edges = build_edge_graph(ground);
    ground.sides = {Patch::kYMin, Patch::kXMax, Patch::kYMax, Patch::kXMin};
    for (const EdgeIndex e : edges.vertices.indices()) {
      if (edges.triangles[e][1] != kNoTriangle) continue;
      const auto [a, b] = edges.vertices[e];
      ground.tagged_edges.push_back({a, b, kNoRegion, 0});
    }
    roofs = reconcile_roofs(ground, edges, planes, kLeastStep);
    for (const Point2 p : ground.vertices) plan.ground.push_back(0.05 * p.x - 0.03 * p.y);
    plan.roofs = roofs.roofs;
    plan.lowest_roof = lowest_roofs(ground, plan.roofs);
    plan.top.assign(ground.vertices.size(), kTop);
    plan.spacing = column_spacing(ground);
    plan.rise = ground_rise(ground, plan.ground);
    for (;;) {
      mesh = divide_columns(std::move(ground), std::move(edges), plan);
      place_nodes(mesh, plan);
      if (plan.roofs.all_flat()) break;
      const std::int64_t now = find_levels(mesh, plan.roofs);
      closed += now;
      if (now == 0) break;
      ground = std::move(mesh.ground);
      edges = std::move(mesh.edges);
    }
  }

  double floor(RegionIndex region, VertexIndex v) const {
    return plan.floor(mesh.ground, region, v);
  }
};

double volume_above_floors(const SlopedParts& city) {
  double volume = 0;
  const GroundMesh& ground = city.mesh.ground;
  for (const TriangleIndex t : ground.triangles.indices()) {
    const auto& v = ground.triangles[t];
    const Point2 a = ground.vertices[v[0]], b = ground.vertices[v[1]], c = ground.vertices[v[2]];
    const double area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    for (const VertexIndex u : v) volume += area / 3 * (kTop - city.floor(ground.region[t], u));
  }
  return volume;
}

/// Steps do not cross, are none or kLeastStep, and walls around each vertex are a manifold.
void expect_reconciled(const SlopedParts& city) {
  const ColumnMesh& mesh = city.mesh;
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    std::vector<double> z;
    for (const RegionIndex r : mesh.regions[v])
      if (mesh.ground.regions[r].is_building()) z.push_back(city.floor(r, v));
    std::sort(z.begin(), z.end());
    for (std::size_t i = 1; i < z.size(); ++i)
      EXPECT_TRUE(z[i] == z[i - 1] || z[i] - z[i - 1] >= kLeastStep - 1e-12) << z[i] - z[i - 1];
  }
  for (const EdgeIndex e : mesh.edges.vertices.indices()) {
    if (!is_step(mesh, e)) continue;
    const auto [t0, t1] = mesh.edges.triangles[e];
    double least = 0, most = 0;
    for (const VertexIndex v : mesh.edges.vertices[e]) {
      const double step =
          city.floor(mesh.ground.region[t0], v) - city.floor(mesh.ground.region[t1], v);
      least = std::min(least, step);
      most = std::max(most, step);
    }
    EXPECT_TRUE(least == 0 || most == 0);
    EXPECT_TRUE(passes(mesh, e));
  }
}

void expect_sound(const SlopedParts& city) {
  const ColumnMesh& mesh = city.mesh;
  EXPECT_GT(require_valid(mesh), 0);
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    for (const RegionIndex region : mesh.regions[v])
      EXPECT_EQ(mesh.z[mesh.floor(region, v)], city.floor(region, v));
    for (const NodeIndex n : indices(mesh.first[v], mesh.top(v)))
      EXPECT_LT(mesh.climbing()[n], mesh.climbing()[n + 1]);
  }
  const SurfaceMesh surface = extract_boundary(mesh);
  const SurfaceTopology topology = check_topology(surface);
  EXPECT_TRUE(topology.closed()) << topology.open_edges;
  EXPECT_TRUE(topology.manifold()) << topology.non_manifold_edges;
  auto lists = testing::explicit_mesh(mesh);
  const TetMesh tets{std::move(lists.points), std::move(lists.cells), {}};
  const VolumeCheck check = check_volume(tets);
  EXPECT_EQ(check.inverted, 0);
  const double expected = volume_above_floors(city);
  EXPECT_NEAR(check.volume, expected, 1e-9 * expected);
  // By faces of cells alone: conforming, and with this boundary.
  const auto differences = check_same_boundary(tets, check, surface);
  EXPECT_TRUE(differences.empty()) << differences[0].first;
}

TEST(SlopedRoofs, AnyPartsMakeAClosedManifoldOfPositiveCells) {
  std::mt19937 random(testing::test_seed());
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const double steepest = trial % 3 == 0 ? 20 : trial % 3 == 1 ? 45 : 70;
    SlopedParts city(10 + trial % 5, 1 + trial % 7, steepest, random);
    expect_reconciled(city);
    expect_sound(city);
    if (HasFailure()) return;
    SCOPED_TRACE("improved");
    improve_columns(city.mesh);
    expect_reconciled(city);
    expect_sound(city);
    if (HasFailure()) return;
  }
}

TEST(SlopedRoofs, FlatRoofsHaveNoLevels) {
  std::mt19937 random(testing::test_seed());
  const SlopedParts city(9, 1, 0, random);
  EXPECT_TRUE(city.plan.roofs.all_flat());
  EXPECT_TRUE(city.mesh.levels.empty());
}

/// Two roofs that touch at the corner of a third alone: the line between them has no pieces, so
/// nothing shortens the edges of 4 m there.
TEST(SlopedRoofs, NearRoofsAtTheCornerOfAThirdMeetWhereTrianglesAreLong) {
  for (const double step : {0.2, 0.4, 0.7, 0.8, 2.0}) {
    SCOPED_TRACE(step);
    const std::vector<RoofPlane> planes{
        {{0, 0}, 10, 0, 0}, {{0, 0}, 10 + step, 0, 0}, {{0, 0}, 15, 0, 0}};
    GroundMesh ground;
    for (int p = 0; p < 3; ++p)
      ground.regions.push_back({RegionKind::kBuildingPart, BuildingIndex(0), p, Patch::kRoof});
    ground.regions.push_back({});
    const auto at = [](int i, int j) { return VertexIndex(3 * j + i); };
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) ground.vertices.push_back({4.0 * i, 4.0 * j});
    // From the south-west: open ground, the second roof; the first one, the third.
    const std::array<std::array<int, 2>, 2> regions{{{3, 1}, {0, 2}}};
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        ground.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        ground.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        for (int k = 0; k < 2; ++k)
          ground.region.push_back(
              RegionIndex(regions[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)]));
      }
    const ReconciledRoofs met =
        reconcile_roofs(ground, build_edge_graph(ground), planes, kLeastStep);
    // Triangles reach 4 m from the corner. A cell over one is as sharp as the step over this.
    const bool is_thin = step < kLeastStep || (step < 0.75 && step < 4.0 / 6);
    EXPECT_EQ(met.closed, is_thin ? 1 : 0);
    const VertexIndex corner = at(1, 1);
    EXPECT_NEAR(met.roofs.at(RegionIndex(1), corner) - met.roofs.at(RegionIndex(0), corner),
                is_thin ? 0 : step, 1e-9);
    EXPECT_EQ(met.roofs.at(RegionIndex(2), corner), 15);
  }
}

TEST(SlopedRoofs, PartyLinesHaveAVertexWhereRoofsCrossAndShortEdgesAtLowSteps) {
  const RoofPlane flat{{0, 0}, 10, 0, 0}, rising{{0, 0}, 8, 0.25, 0};
  const std::vector<LinePiece> pieces =
      divide_party_line(flat, rising, {0, 3}, {20, 3}, 10, kLeastStep);
  double from = 0;
  bool crosses = false;
  for (const LinePiece& piece : pieces) {
    crosses |= std::abs(piece.end.x - 8) < 1e-9;
    const auto [least, most] = std::minmax({std::abs(flat({from, 3}) - rising({from, 3})),
                                            std::abs(flat(piece.end) - rising(piece.end))});
    EXPECT_LE(piece.end.x - from, piece.max_edge + 1e-9);
    if (most > kLeastStep) {
      EXPECT_LE(piece.max_edge, std::min(10.0, 4 * std::max(least, kLeastStep)) + 1e-9);
    }
    from = piece.end.x;
  }
  EXPECT_TRUE(crosses);
  EXPECT_EQ(pieces.back().end, (Point2{20, 3}));
  // Roofs that are one.
  EXPECT_EQ(divide_party_line(flat, flat, {0, 3}, {20, 3}, 10, kLeastStep).size(), 2U);
}

}  // namespace
}  // namespace tetropolis
