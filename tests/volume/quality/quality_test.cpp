#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "core/units.h"
#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "support/test_data.h"
#include "support/tet_shape.h"
#include "volume/quality/measured_mesh.h"

namespace tetropolis {
namespace {

TEST(Quality, KnownTetrahedra) {
  const double h = 1 / std::sqrt(2.0);
  const testing::TetShape regular =
      testing::tet_shape({1, 0, -h}, {-1, 0, -h}, {0, 1, h}, {0, -1, h});
  EXPECT_NEAR(regular.min_dihedral_deg, to_degrees(std::acos(1.0 / 3)), 1e-9);
  EXPECT_NEAR(regular.max_dihedral_deg, to_degrees(std::acos(1.0 / 3)), 1e-9);
  EXPECT_NEAR(regular.aspect_ratio, 1, 1e-12);
  EXPECT_NEAR(std::abs(regular.volume), 8 / (6 * std::sqrt(2.0)), 1e-12);

  const testing::TetShape corner = testing::tet_shape({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_NEAR(corner.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(corner.max_dihedral_deg, 90, 1e-9);
  EXPECT_NEAR(corner.min_dihedral_deg, to_degrees(std::acos(1 / std::sqrt(3.0))), 1e-9);

  const testing::TetShape mirrored = testing::tet_shape({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_NEAR(mirrored.volume, -1.0 / 6, 1e-15);
  const testing::TetShape flat = testing::tet_shape({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  EXPECT_EQ(flat.volume, 0);
  EXPECT_TRUE(std::isinf(flat.aspect_ratio));
}

TEST(Quality, QuantilesAreThoseOfTheSortedValues) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> coordinate(0, 1);
  QualityHistogram histogram;
  std::vector<double> angles, aspects;
  for (int i = 0; i < 20000; ++i) {
    const auto p = [&] {
      return Point3{coordinate(random), coordinate(random), coordinate(random)};
    };
    const testing::TetShape shape = testing::tet_shape(p(), p(), p(), p());
    const double cosine = std::cos(to_radians(shape.min_dihedral_deg));
    const double square = shape.aspect_ratio * shape.aspect_ratio;
    histogram.add({&cosine, 1}, {&square, 1}, 0);
    histogram.widen(cosine, std::cos(to_radians(shape.max_dihedral_deg)), shape.aspect_ratio);
    angles.push_back(shape.min_dihedral_deg);
    aspects.push_back(shape.aspect_ratio);
  }
  std::sort(angles.begin(), angles.end());
  std::sort(aspects.begin(), aspects.end());
  for (const double share : {0.0001, 0.001, 0.01, 0.5, 0.99}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * 20000)) - 1;
    EXPECT_NEAR(histogram.dihedral_quantile_deg(share), angles[rank], 0.0051);
    EXPECT_NEAR(histogram.aspect_quantile(share) / aspects[rank], 1, 0.002);
  }
  EXPECT_NEAR(histogram.min_dihedral_deg(), angles.front(), 1e-9);
  EXPECT_EQ(histogram.max_aspect_ratio(), aspects.back());
}

TEST(Quality, SumsOverAMeshDoNotDependOnThreads) {
  const auto result = testing::meshed(testing::small_city([](double, double) { return 0.0; }));
  std::vector<double> volumes;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const QualityHistogram quality = measure_cells(result.mesh).histogram;
    EXPECT_EQ(quality.cells(), cell_offsets(result.mesh).back());
    volumes.push_back(quality.volume());
  }
  EXPECT_EQ(volumes[0], volumes[1]);
  // The domain's box less the buildings' prisms.
  double expected = 120 * 90 * result.plan.layers.top;
  const std::vector<double> areas{18 * 12, 15.5 * 25, 35 * 40 - 15 * 20, 42, 0};
  for (std::size_t b = 0; b < 4; ++b) expected -= areas[b] * result.city.roofs[b];
  double last = 0;
  const Ring& ring = result.city.footprints[4].outer;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 u = ring[i], v = ring[(i + 1) % ring.size()];
    last += (u.x * v.y - v.x * u.y) / 2;
  }
  expected -= last * result.city.roofs[4];
  EXPECT_NEAR(volumes[0] / expected, 1, 1e-12);
}

/// Centre of a cell of the explicit lists.
Point3 centre(const testing::ExplicitMesh& mesh, std::size_t cell) {
  Point3 sum{};
  for (const std::int64_t n : mesh.cells[cell])
    for (std::size_t c = 0; c < 3; ++c) sum[c] += mesh.points[static_cast<std::size_t>(n)][c] / 4;
  return sum;
}

class FacesOf : public ::testing::TestWithParam<double> {};

TEST_P(FacesOf, CellsAreThoseSharedByTwo) {
  auto result = testing::meshed(testing::small_city(testing::hills));
  for (double& z : result.mesh.z) z *= GetParam();
  const auto lists = testing::explicit_mesh(result.mesh);
  std::map<std::array<std::int64_t, 3>, std::vector<std::size_t>> faces;
  for (std::size_t cell = 0; cell < lists.cells.size(); ++cell)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::array<std::int64_t, 3> face{};
      for (std::size_t i = 0, n = 0; i < 4; ++i)
        if (i != skip) face[n++] = lists.cells[cell][i];
      std::sort(face.begin(), face.end());
      faces[face].push_back(cell);
    }
  FaceQuality expected;
  double most_on_boundary = 0;
  std::vector<std::uint8_t> above(result.mesh.triangle_count(), 0);
  for (const auto& [nodes, cells] : faces) {
    std::array<Point3, 3> face;
    for (std::size_t i = 0; i < 3; ++i) face[i] = lists.points[static_cast<std::size_t>(nodes[i])];
    if (cells.size() == 1) {
      most_on_boundary =
          std::max(most_on_boundary, boundary_skewness(face, centre(lists, cells[0])));
      continue;
    }
    const FaceShape shape = face_shape(face, centre(lists, cells[0]), centre(lists, cells[1]));
    ++expected.faces;
    if (shape.non_orthogonality_deg > 70) {
      ++expected.above_70;
      for (const std::size_t cell : cells) above[lists.triangle[cell]] = 1;
    }
    expected.worst = {std::max(expected.worst.non_orthogonality_deg, shape.non_orthogonality_deg),
                      std::max(expected.worst.skewness, shape.skewness)};
  }
  EXPECT_GT(expected.worst.non_orthogonality_deg, 0);
  EXPECT_GT(most_on_boundary, 0);
  expected.worst.skewness = std::max(expected.worst.skewness, most_on_boundary);
  const FaceQuality measured = measure_faces(result.mesh);
  EXPECT_EQ(measured.faces, expected.faces);
  EXPECT_EQ(measured.above_70, expected.above_70);
  EXPECT_NEAR(measured.worst.non_orthogonality_deg, expected.worst.non_orthogonality_deg, 1e-6);
  EXPECT_NEAR(measured.worst.skewness, expected.worst.skewness, 1e-9);
  const MeasuredMesh faults(result.mesh);
  EXPECT_EQ(faults.steep_triangles(result.mesh), above);
  EXPECT_EQ(faults.counts().steep_faces, expected.above_70);
  EXPECT_NEAR(faults.counts().worst_face_deg,
              expected.above_70 > 0 ? expected.worst.non_orthogonality_deg : 0, 1e-5);
}

// Stretched or squeezed ones have faces above 70 degrees.
INSTANTIATE_TEST_SUITE_P(Quality, FacesOf, ::testing::Values(1.0, 0.1, 10.0));

TEST(Quality, ShapesOfCellsAreThoseOfTetShape) {
  // Squeezed and stretched, for angles and ratios far from the usual ones, too.
  for (const double stretch : {1.0, 0.05, 20.0}) {
    auto result = testing::meshed(testing::small_city(testing::hills));
    for (double& z : result.mesh.z) z *= stretch;
    const auto lists = testing::explicit_mesh(result.mesh);
    std::vector<double> angles, aspects;
    double volume = 0, greatest = 0;
    for (const auto& cell : lists.cells) {
      const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(cell[i])]; };
      const testing::TetShape shape = testing::tet_shape(p(0), p(1), p(2), p(3));
      angles.push_back(shape.min_dihedral_deg);
      aspects.push_back(shape.aspect_ratio);
      greatest = std::max(greatest, shape.max_dihedral_deg);
      volume += shape.volume;
    }
    std::sort(angles.begin(), angles.end());
    std::sort(aspects.begin(), aspects.end());
    const QualityHistogram quality = measure_cells(result.mesh).histogram;
    EXPECT_NEAR(quality.min_dihedral_deg(), angles.front(), 1e-9);
    EXPECT_NEAR(quality.max_dihedral_deg(), greatest, 1e-9);
    EXPECT_NEAR(quality.max_aspect_ratio() / aspects.back(), 1, 1e-12);
    EXPECT_NEAR(quality.volume() / volume, 1, 1e-12);
    for (const double share : {0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99}) {
      const auto rank =
          static_cast<std::size_t>(std::ceil(share * static_cast<double>(angles.size()))) - 1;
      EXPECT_NEAR(quality.dihedral_quantile_deg(share), angles[rank], 0.0051) << stretch;
      EXPECT_NEAR(quality.aspect_quantile(share) / aspects[rank], 1, 0.0006) << stretch;
    }
  }
}

TEST(Quality, KnownFace) {
  const std::array<Point3, 3> face{{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}};
  const FaceShape straight = face_shape(face, {1, 1, -2}, {1, 1, 4});
  EXPECT_NEAR(straight.non_orthogonality_deg, 0, 1e-6);
  EXPECT_NEAR(straight.skewness, 0, 1e-12);
  // The line leans 45 degrees and meets the plane in (0, 1), 1 m from the centre; the face reaches
  // 2 m from its centre in that direction.
  const FaceShape leaning = face_shape(face, {-1, 1, -1}, {1, 1, 1});
  EXPECT_NEAR(leaning.non_orthogonality_deg, 45, 1e-9);
  EXPECT_NEAR(leaning.skewness, 0.5, 1e-12);
}

TEST(Quality, KnownFaceOnTheBoundary) {
  const std::array<Point3, 3> face{{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}};
  EXPECT_NEAR(boundary_skewness(face, {1, 1, -2}), 0, 1e-12);
  // The perpendicular meets the plane in (0, 1), 1 m from the centre; the face reaches 2 m from its
  // centre in that direction, more than 0.4 of 1 m, and less than 0.4 of 10 m.
  EXPECT_NEAR(boundary_skewness(face, {0, 1, -1}), 0.5, 1e-12);
  EXPECT_NEAR(boundary_skewness(face, {0, 1, 10}), 0.25, 1e-12);
}

TEST(Quality, ListsTheWorstCellsWithTheirPlace) {
  const auto result = testing::meshed(testing::small_city(testing::hills));
  const auto lists = testing::explicit_mesh(result.mesh);
  struct Cell {
    double share_of_floor, least, greatest;
    Point3 centre;
  };
  std::vector<Cell> cells;
  for (const auto& cell : lists.cells) {
    const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(cell[i])]; };
    const testing::TetShape shape = testing::tet_shape(p(0), p(1), p(2), p(3));
    cells.push_back(
        {std::min(shape.min_dihedral_deg / 12, (180 - shape.max_dihedral_deg) / 20),
         shape.min_dihedral_deg,
         shape.max_dihedral_deg,
         {(p(0)[0] + p(1)[0] + p(2)[0] + p(3)[0]) / 4, (p(0)[1] + p(1)[1] + p(2)[1] + p(3)[1]) / 4,
          (p(0)[2] + p(1)[2] + p(2)[2] + p(3)[2]) / 4}});
  }
  std::sort(cells.begin(), cells.end(),
            [](const Cell& a, const Cell& b) { return a.share_of_floor < b.share_of_floor; });
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const CellQuality quality = measure_cells(result.mesh, 10);
    ASSERT_EQ(quality.worst.size(), 10U);
    for (std::size_t i = 0; i < 10; ++i) {
      const WorstCell& found = quality.worst[i];
      EXPECT_EQ(found.share_of_floor, cells[i].share_of_floor);
      // Cells may be equally bad: any of these.
      EXPECT_TRUE(std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
        return cell.share_of_floor == found.share_of_floor &&
               cell.least == found.min_dihedral_deg && cell.greatest == found.max_dihedral_deg &&
               std::abs(cell.centre[0] - found.centre[0]) < 1e-9 &&
               std::abs(cell.centre[1] - found.centre[1]) < 1e-9 &&
               std::abs(cell.centre[2] - found.centre[2]) < 1e-9;
      })) << i;
      EXPECT_FALSE(quality.worst[i].cause.empty());
    }
  }
}

TEST(Quality, TheCauseOfTheWorstCellIsTheOneThatIsThere) {
  const auto flat = [](double, double) { return 0.0; };
  testing::SmallCity city;
  const auto cause = [](const ColumnMesh& mesh) { return measure_cells(mesh, 1).worst[0].cause; };
  city.dtm = testing::raster_of(city.domain, [](double x, double) { return x < 60 ? 0.0 : 20.0; });
  EXPECT_EQ(cause(testing::meshed(city).mesh), "steep ground");
  city.dtm = testing::raster_of(city.domain, flat);
  auto empty = testing::meshed(city);
  empty.plan.spacing.assign(empty.plan.spacing.size(), 1);
  ColumnMesh thin = divide_columns(empty.mesh.ground, empty.mesh.edges, empty.plan);
  place_nodes(thin, empty.plan);
  EXPECT_EQ(cause(thin), "change of size");
  city.footprints = {testing::rectangle(40, 30, 80, 60)};
  city.roofs = {1};
  EXPECT_EQ(cause(testing::meshed(city).mesh), "low wall");
  city.footprints = {testing::rectangle(20, 30, 50, 60), testing::rectangle(50.5, 30, 80, 60)};
  city.roofs = {20, 20};
  EXPECT_EQ(cause(columns_of_layers(testing::layered(city).mesh)), "small detail");
}

}  // namespace
}  // namespace tetropolis
