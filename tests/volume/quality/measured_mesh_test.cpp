#include "volume/quality/measured_mesh.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "core/units.h"
#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "support/spoilt_mesh.h"
#include "support/tet_shape.h"
#include "volume/quality/cells_of.h"
#include "volume/quality/faces_of.h"
#include "volume/quality/stack_kernels.h"

namespace tetropolis {
namespace {

using Counting = MeasuredMesh::Counting;

ColumnMesh spoilt_city(double (*terrain)(double, double), double share) {
  return testing::spoilt(testing::meshed(testing::small_city(terrain)).mesh, share);
}

void expect_same(const MeasuredMesh& found, const MeasuredMesh& expected, const ColumnMesh& mesh) {
  EXPECT_EQ(found.counts(), expected.counts());
  for (const Asked asked : {Asked::kFloor, Asked::kOfMost, Asked::kGood})
    EXPECT_EQ(found.bad_triangles(mesh, asked), expected.bad_triangles(mesh, asked));
  const MeshQuality a = found.quality(mesh, 10), b = expected.quality(mesh, 10);
  EXPECT_EQ(a.cells.histogram, b.cells.histogram);
  EXPECT_EQ(a.faces.faces, b.faces.faces);
  EXPECT_EQ(a.faces.above_70, b.faces.above_70);
  EXPECT_EQ(a.faces.worst.non_orthogonality_deg, b.faces.worst.non_orthogonality_deg);
  EXPECT_EQ(a.faces.worst.skewness, b.faces.worst.skewness);
  ASSERT_EQ(a.cells.worst.size(), b.cells.worst.size());
  for (std::size_t i = 0; i < a.cells.worst.size(); ++i) {
    EXPECT_EQ(a.cells.worst[i].share_of_floor, b.cells.worst[i].share_of_floor);
    EXPECT_EQ(a.cells.worst[i].centre, b.cells.worst[i].centre);
  }
}

/// Of every single cell.
TEST(StackKernels, CellsAreThoseOfTetShape) {
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    const ColumnMesh mesh = spoilt_city(terrain, 0.5);
    const auto lists = testing::explicit_mesh(mesh);
    std::size_t cell = 0;
    FrontStore store;
    StackKernels kernels;
    for (const TriangleIndex t : mesh.ground.triangles.indices()) {
      if (t.value() % 7 == 0) store.clear();
      store.add(mesh, t);
      const Fronts fronts = store[t.value() % 7];
      kernels.measure(fronts);
      double greatest = 0, widest = 0, ratio = 0;
      for (std::size_t k = 0; k < fronts.cells; ++k, ++cell) {
        ASSERT_EQ(lists.triangle[cell], t);
        const auto p = [&](std::size_t i) {
          return lists.points[static_cast<std::size_t>(lists.cells[cell][i])];
        };
        const testing::TetShape shape = testing::tet_shape(p(0), p(1), p(2), p(3));
        ASSERT_NEAR(kernels.greatest()[k], std::cos(to_radians(shape.min_dihedral_deg)), 1e-11);
        ASSERT_NEAR(std::sqrt(kernels.aspect2()[k]) / shape.aspect_ratio, 1, 1e-9);
        greatest = std::max(greatest, std::cos(to_radians(shape.min_dihedral_deg)));
        widest = std::max(widest, shape.max_dihedral_deg);
        ratio = std::max(ratio, shape.aspect_ratio);
      }
      EXPECT_EQ(kernels.cells().inverted, 0);
      EXPECT_NEAR(kernels.cells().greatest, greatest, 1e-11);
      EXPECT_NEAR(kernels.cells().least, std::cos(to_radians(widest)), 1e-11);
      EXPECT_NEAR(std::sqrt(kernels.cells().aspect2) / ratio, 1, 1e-9);
    }
    EXPECT_EQ(cell, lists.cells.size());
  }
}

/// Over every triangle and edge.
TEST(StackKernels, FacesAreThoseOfFaceShape) {
  // Faces that are small beside their cells, or large, are measured in other ways.
  for (const double stretch : {1.0, 0.02, 50.0}) {
    SCOPED_TRACE(stretch);
    ColumnMesh mesh = spoilt_city(testing::hills, 0.5);
    for (double& z : mesh.z) z *= stretch;
    FrontStore store;
    StackKernels kernels;
    for (const TriangleIndex t : mesh.ground.triangles.indices()) store.add(mesh, t);
    std::array<Strip, 2> strips;
    const auto expect_worst = [](const FaceFigures& figures, const FaceQuality& expected,
                                 bool has_boundary) {
      const double cosine = std::cos(to_radians(expected.worst.non_orthogonality_deg));
      ASSERT_NEAR(std::sqrt(figures.straight2), expected.faces > 0 ? cosine : 1, 1e-9);
      if (has_boundary)
        ASSERT_LE(std::sqrt(figures.skewness2), expected.worst.skewness + 1e-7);
      else
        ASSERT_NEAR(std::sqrt(figures.skewness2), expected.worst.skewness, 1e-7);
    };
    for (const TriangleIndex t : mesh.ground.triangles.indices()) {
      kernels.measure(store[t]);
      expect_worst(kernels.faces(), faces_over(mesh, t), false);
    }
    for (const EdgeIndex e : mesh.edges.vertices.indices()) {
      if (mesh.edges.triangles[e][1] == kNoTriangle) continue;
      std::array<Point2, 2> corner;
      for (std::size_t s = 0; s < 2; ++s) {
        const TriangleIndex t = mesh.edges.triangles[e][s];
        const auto& own = mesh.edges.of_triangle[t];
        const std::size_t i =
            static_cast<std::size_t>(2 - (std::find(own.begin(), own.end(), e) - own.begin()));
        gather_strip(store[t], i, strips[s]);
        corner[s] = store[t].corner[i];
      }
      const std::size_t count = std::min(strips[0].faces, strips[1].faces);
      const FaceQuality expected = faces_beside(mesh, e);
      ASSERT_EQ(static_cast<std::int64_t>(count), expected.faces);
      if (count == 0) continue;
      const auto [a, b] = mesh.edges.vertices[e];
      expect_worst(kernels.measure_between(mesh.ground.vertices[a], mesh.ground.vertices[b], corner,
                                           strips, count),
                   expected, strips[0].faces != strips[1].faces);
    }
  }
}

TEST(MeasuredMesh, CountsWhatTheWholeMeshHas) {
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    const ColumnMesh mesh =
        testing::spoilt(testing::meshed(testing::small_city(terrain)).mesh, 0.3);
    const MeasuredMesh faults(mesh);
    const FaultCounts counts = faults.counts();
    const CellQuality cells = measure_cells(mesh, 10'000'000);
    EXPECT_EQ(counts.cells, cells.histogram.cells());
    std::int64_t thin = 0;
    for (const WorstCell& cell : cells.worst) thin += cell.min_dihedral_deg < 12 ? 1 : 0;
    EXPECT_EQ(counts.thin, thin);
    EXPECT_GT(thin, 0);
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i) {
      EXPECT_EQ(counts.outside[i], testing::count_bad_cells(mesh, kAskedBounds[i]));
      std::vector<std::uint8_t> bad = faults.steep_triangles(mesh);
      std::set<TriangleIndex> over;
      for (const WorstCell& cell : cells.worst)
        if (cell.min_dihedral_deg < kAskedBounds[i].least ||
            cell.max_dihedral_deg > kAskedBounds[i].greatest) {
          over.insert(cell.triangle);
          bad[cell.triangle] = 1;
        }
      EXPECT_EQ(counts.triangles[i], static_cast<std::int64_t>(over.size()));
      EXPECT_EQ(faults.bad_triangles(mesh, static_cast<Asked>(i)), bad);
    }
    EXPECT_EQ(counts.steep_faces, measure_faces(mesh).above_70);
  }
}

/// After a search, and back again.
TEST(MeasuredMesh, LookingAgainWhereColumnsChangedIsEnough) {
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    const ColumnMesh before = spoilt_city(terrain, 0.1);
    const MeasuredMesh measured_before(before, Counting::kHistogram);
    ColumnMesh after = before;
    MeasuredMesh measured = measured_before, without(before);
    ImproveOptions options;
    std::vector<VertexIndex> changing;
    options.before_change = [&](std::span<const VertexIndex> columns) {
      changing.assign(columns.begin(), columns.end());
      measured.forget(after, columns);
    };
    const std::vector<VertexIndex> changed = improve_columns(after, options).columns;
    ASSERT_FALSE(changed.empty());
    EXPECT_EQ(changed, changing);
    for (const VertexIndex v : before.ground.vertices.indices())
      if (testing::column(before, v) != testing::column(after, v)) {
        EXPECT_TRUE(std::binary_search(changed.begin(), changed.end(), v));
      }
    measured.look_again(after, changed);
    without.look_again(after, changed);
    const MeasuredMesh anew(after, Counting::kHistogram);
    EXPECT_LT(anew.counts().thin, measured_before.counts().thin);
    expect_same(measured, anew, after);
    EXPECT_EQ(without.counts(), anew.counts());
    measured.forget(after, changed);
    measured.look_again(before, changed);
    expect_same(measured, measured_before, before);
  }
}

TEST(MeasuredMesh, DoesNotDependOnThreads) {
  const ColumnMesh mesh =
      testing::spoilt(testing::meshed(testing::small_city(testing::hills), 2).mesh, 0.1);
  std::vector<MeasuredMesh> measured;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    measured.emplace_back(mesh, Counting::kHistogram);
    expect_same(measured.back(), measured.front(), mesh);
  }
}

}  // namespace
}  // namespace tetropolis
