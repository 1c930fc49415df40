#include "volume/upper/grow_upper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/explicit_mesh.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "volume/quality/tet_cosines.h"
#include "volume/upper/lid.h"

namespace tetropolis {
namespace {

/// Columns up to the lid, and what grows from there.
testing::MeshedCity grown(double (*terrain)(double, double), double mesh_size) {
  testing::MeshedCity result = testing::meshed(testing::small_city(terrain), mesh_size);
  lower_tops(result.mesh.ground, result.mesh.edges, result.plan);
  result.mesh =
      divide_columns(std::move(result.mesh.ground), std::move(result.mesh.edges), result.plan);
  place_nodes(result.mesh, result.plan);
  result.mesh.upper = grow_upper(result.mesh, result.plan.layers.top);
  return result;
}

using Nodes = std::array<std::int64_t, 3>;

/// A face with the lowest node first, in its direction.
Nodes turned(Nodes nodes) {
  std::rotate(nodes.begin(), std::min_element(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Per face, in the direction that leaves it, the cell.
std::map<Nodes, std::int64_t> faces_of(const testing::ExplicitMesh& lists) {
  std::map<Nodes, std::int64_t> faces;
  for (std::size_t c = 0; c < lists.cells.size(); ++c) {
    const auto& n = lists.cells[c];
    for (const Nodes& face : {Nodes{n[0], n[2], n[1]}, Nodes{n[0], n[1], n[3]},
                              Nodes{n[1], n[2], n[3]}, Nodes{n[0], n[3], n[2]}})
      EXPECT_TRUE(faces.emplace(turned(face), static_cast<std::int64_t>(c)).second);
  }
  return faces;
}

TEST(GrowUpper, ConformsAndFillsTheDomain) {
  for (const auto& [name, terrain] : testing::kHardTerrains)
    for (const double size : {12.0, 5.0}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(size));
      const testing::MeshedCity city = grown(terrain, size);
      const ColumnMesh& mesh = city.mesh;
      ASSERT_FALSE(mesh.upper.empty());
      const testing::ExplicitMesh lists = testing::explicit_mesh(mesh);
      ASSERT_EQ(lists.points.size(), static_cast<std::size_t>(mesh.node_count()));
      const std::map<Nodes, std::int64_t> faces = faces_of(lists);

      // Each face has one opposite to it, or is on the boundary.
      std::map<Nodes, std::int64_t> outer;
      std::map<std::pair<std::int64_t, std::int64_t>, Nodes> inner;
      for (const auto& [nodes, cell] : faces) {
        const auto opposite = faces.find(turned({nodes[0], nodes[2], nodes[1]}));
        if (opposite == faces.end())
          outer.emplace(nodes, cell);
        else if (cell < opposite->second)
          inner.emplace(std::pair(cell, opposite->second), nodes);
      }
      const SurfaceMesh boundary = extract_boundary(mesh);
      EXPECT_TRUE(check_topology(boundary).closed());
      EXPECT_TRUE(check_topology(boundary).manifold());
      ASSERT_EQ(boundary.triangles.size(), outer.size());
      for (std::size_t f = 0; f < boundary.triangles.size(); ++f) {
        Nodes nodes{};
        for (std::size_t i = 0; i < 3; ++i)
          nodes[i] = boundary.node[static_cast<std::size_t>(boundary.triangles[f][i])].value();
        const auto found = outer.find(turned(nodes));
        ASSERT_NE(found, outer.end());
        EXPECT_EQ(boundary.cell[f], CellIndex(found->second));
        double low = 1e9, high = -1e9;
        for (const std::int32_t p : boundary.triangles[f]) {
          low = std::min(low, boundary.points[static_cast<std::size_t>(p)][2]);
          high = std::max(high, boundary.points[static_cast<std::size_t>(p)][2]);
        }
        EXPECT_EQ(boundary.patch[f] == Patch::kTop, low == city.plan.layers.top) << high;
      }

      // As OpenFOAM wants them.
      const std::vector<CellIndex> cells = cell_offsets(mesh);
      EXPECT_EQ(cells.back().value(), static_cast<std::int64_t>(lists.cells.size()));
      auto expected = inner.begin();
      for (const CellFace& face : internal_faces(mesh)) {
        ASSERT_NE(expected, inner.end());
        EXPECT_EQ(expected->first, std::pair(face.owner.value(), face.neighbour.value()));
        EXPECT_EQ(face.corners, 3U);
        const auto& n = face.nodes;
        EXPECT_EQ(expected->second, turned({n[0].value(), n[1].value(), n[2].value()}));
        ++expected;
      }
      EXPECT_EQ(expected, inner.end());

      double volume = 0, expected_volume = 0;
      for (const auto& c : lists.cells) {
        const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(c[i])]; };
        const double own = tet_cosines(p(0), p(1), p(2), p(3)).volume;
        EXPECT_GT(own, 0);
        volume += own;
      }
      for (const TriangleIndex t : mesh.ground.triangles.indices()) {
        const auto& v = mesh.ground.triangles[t];
        const auto at = [&](std::size_t i) { return mesh.ground.vertices[v[i]]; };
        const double area = ((at(1).x - at(0).x) * (at(2).y - at(0).y) -
                             (at(1).y - at(0).y) * (at(2).x - at(0).x)) /
                            2;
        for (const VertexIndex u : v)
          expected_volume += area / 3 * (city.plan.layers.top - mesh.z[mesh.floor_over(t, u)]);
      }
      EXPECT_NEAR(volume / expected_volume, 1, 1e-12);
    }
}

TEST(GrowUpper, EndsWhenItIsCancelled) {
  testing::MeshedCity city = grown(testing::hills, 6);
  city.mesh.upper = {};
  const auto grow = [&](int after) {
    int polls = 0;
    const Progress progress{{}, [&] { return ++polls > after; }};
    grow_upper(city.mesh, city.plan.layers.top, progress, 3);
    return polls;
  };
  constexpr int kNever = 1'000'000;
  const int polls = grow(kNever);
  EXPECT_GT(polls, 3);
  for (const int after : {0, 1, polls / 2, polls - 1})
    EXPECT_THROW(grow(after), Cancelled) << after;
}

TEST(GrowUpper, QualityIsThatOfAllCellsAndFaces) {
  const testing::MeshedCity city = grown(testing::hills, 6);
  const ColumnMesh& mesh = city.mesh;
  const testing::ExplicitMesh lists = testing::explicit_mesh(mesh);
  std::vector<Point3> centres;
  double greatest = -1, least = 1;
  for (const auto& c : lists.cells) {
    const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(c[i])]; };
    const TetCosines shape = tet_cosines(p(0), p(1), p(2), p(3));
    greatest = std::max(greatest, shape.greatest);
    least = std::min(least, shape.least);
    centres.push_back(centre_of({p(0), p(1), p(2), p(3)}));
  }
  const CellQuality cells = measure_cells(mesh, 5);
  EXPECT_EQ(cells.histogram.cells(), static_cast<std::int64_t>(lists.cells.size()));
  EXPECT_NEAR(cells.histogram.min_dihedral_deg(), angle_deg(greatest), 1e-9);
  EXPECT_NEAR(cells.histogram.max_dihedral_deg(), angle_deg(least), 1e-9);
  ASSERT_EQ(cells.worst.size(), 5U);
  EXPECT_TRUE(std::is_sorted(
      cells.worst.begin(), cells.worst.end(),
      [](const WorstCell& a, const WorstCell& b) { return a.share_of_floor < b.share_of_floor; }));

  const FaceQuality faces = measure_faces(mesh);
  std::int64_t count = 0;
  double worst = 0, skewness = 0;
  const std::map<Nodes, std::int64_t> all = faces_of(lists);
  for (const auto& face : all) {
    const Nodes& nodes = face.first;
    const std::int64_t cell = face.second;
    const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(nodes[i])]; };
    const auto opposite = all.find(turned({nodes[0], nodes[2], nodes[1]}));
    const Point3& centre = centres[static_cast<std::size_t>(cell)];
    if (opposite == all.end()) {
      skewness = std::max(skewness, boundary_skewness({p(0), p(1), p(2)}, centre));
    } else if (cell < opposite->second) {
      const FaceShape shape = face_shape({p(0), p(1), p(2)}, centre,
                                         centres[static_cast<std::size_t>(opposite->second)]);
      ++count;
      worst = std::max(worst, shape.non_orthogonality_deg);
      skewness = std::max(skewness, shape.skewness);
    }
  }
  EXPECT_EQ(faces.faces, count);
  EXPECT_NEAR(faces.worst.non_orthogonality_deg, worst, 1e-9);
  EXPECT_NEAR(faces.worst.skewness, skewness, 1e-9);
}

TEST(GrowUpper, FewCellsAreFarAboveTheRoofs) {
  for (const double size : {10.0, 5.0, 2.5}) {
    SCOPED_TRACE(size);
    const testing::MeshedCity city = grown(testing::hills, size);
    const testing::ExplicitMesh lists = testing::explicit_mesh(city.mesh);
    const double roof = *std::ranges::max_element(city.city.roofs);
    const auto high = std::ranges::count_if(lists.cells, [&](const auto& c) {
      double z = 0;
      for (const std::int64_t n : c) z += lists.points[static_cast<std::size_t>(n)][2] / 4;
      return z > roof + 10;
    });
    EXPECT_LT(static_cast<double>(high), 0.5 * static_cast<double>(lists.cells.size()));
    const CellQuality cells = measure_cells(city.mesh);
    EXPECT_GT(cells.histogram.min_dihedral_deg(), kQualityFloor.least);
    EXPECT_LT(cells.histogram.max_dihedral_deg(), kQualityFloor.greatest);
    EXPECT_EQ(measure_faces(city.mesh).above_70, 0);
  }
}

TEST(Lid, IsAboveTheFloorsAndNoSteeperThanItMayBe) {
  const testing::MeshedCity city = grown(testing::hills, 6);
  const GroundMesh& ground = city.mesh.ground;
  for (const TriangleIndex t : ground.triangles.indices())
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = ground.triangles[t][i], u = ground.triangles[t][(i + 1) % 3];
      const double floor = city.plan.floor(ground, ground.region[t], v);
      EXPECT_GE(city.plan.top[v], std::min(floor + 2 * city.plan.spacing[v], city.plan.layers.top));
      const Point2 p = ground.vertices[v], q = ground.vertices[u];
      if (city.plan.top[v] < city.plan.layers.top && city.plan.top[u] < city.plan.layers.top) {
        EXPECT_LE(std::abs(city.plan.top[v] - city.plan.top[u]),
                  std::hypot(q.x - p.x, q.y - p.y) + 1e-5);
      }
    }
}

TEST(GrowUpper, IsTheSameForAnyNumberOfTiles) {
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    ColumnMesh mesh = grown(terrain, 4).mesh;
    const UpperMesh one = std::exchange(mesh.upper, {});
    const double top = *std::max_element(one.z.begin(), one.z.end());
    for (const std::size_t tiles : {1, 2, 3, 7}) {
      const UpperMesh several = grow_upper(mesh, top, {}, tiles);
      EXPECT_EQ(several.z, one.z);
      EXPECT_EQ(several.vertex, one.vertex);
      ASSERT_EQ(several.cells(), one.cells());
      std::vector<UpperMesh::Cell> cells;
      const auto keep = [&](const UpperMesh::Cell& cell) { cells.push_back(cell); };
      one.for_each_cell(0, one.cells(), keep);
      several.for_each_cell(0, one.cells(), keep);
      EXPECT_TRUE(std::equal(cells.begin() + std::ssize(cells) / 2, cells.end(), cells.begin()));
      EXPECT_EQ(several.over_lid, one.over_lid);
    }
  }
}

}  // namespace
}  // namespace tetropolis
