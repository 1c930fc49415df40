// Guards against regressions of speed by counts of work on a fixed small city, which do not depend
// on the machine. Limits and how to change them: limits.txt.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "core/units.h"
#include "counters.h"
#include "geometry/predicates.h"
#include "stages.h"
#include "support/test_data.h"
#include "work_limits.h"

namespace tetropolis::testing {
namespace {

constexpr std::int64_t kBuildings = 100;

double smallest_angle_deg(const GroundMesh& mesh, const std::array<VertexIndex, 3>& triangle) {
  std::array<Point2, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.vertices[static_cast<std::size_t>(triangle[i])];
  double least = 180;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point2 a = p[i], b = p[(i + 1) % 3], c = p[(i + 2) % 3];
    const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
    least = std::min(least, to_degrees(std::atan2(ux * vy - uy * vx, ux * vx + uy * vy)));
  }
  return least;
}

class Work : public ::testing::Test {
 protected:
  /// Counts what `stage` does.
  template <typename Stage>
  auto count(const Stage& stage) {
    start_counting();
    auto result = stage();
    counted = counts();
    return result;
  }
  void expect_allocations(const std::string& stage) const {
    expect_work(stage + ".allocations", static_cast<double>(counted.allocations));
    expect_work(stage + ".allocated_bytes", static_cast<double>(counted.allocated_bytes));
  }
  void expect_bytes_per(const std::string& stage, const std::string& item, double items) const {
    expect_work(stage + ".peak_bytes_per_" + item, static_cast<double>(counted.peak_bytes) / items);
  }

  const ThreadLimit one_thread{1};
  const WorkCity city = work_city(kBuildings);
  const GroundMesh ground = work_ground(city);
  Counts counted;
};

double cells_of(const ColumnMesh& mesh) {
  return static_cast<double>(cell_offsets(mesh).back().value());
}

TEST_F(Work, CountersCount) {
  // The third point is on the line to within rounding, the fourth on the circle.
  const Point2 a{0.1, 0.1}, b{0.3, 0.3}, c{0.2, 0.2};
  count([&] { return orient2d(a, b, c); });
  EXPECT_EQ(counted.exact_orientations, 1);
  count([&] { return incircle({0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}); });
  EXPECT_EQ(counted.exact_circles, 1);
  count([&] { return std::vector<double>(1000).size(); });
  EXPECT_EQ(counted.allocations, 1);
  EXPECT_EQ(counted.allocated_bytes, 8000);
  EXPECT_GE(counted.peak_bytes, 8000);
  count([&] { return orient2d({0, 0}, {1, 0}, {0, 1}); });
  EXPECT_EQ(counted.exact_orientations + counted.allocations, 0);
  count([&] { return work_simplify(city); });
  EXPECT_GT(counted.geos_operations, 0);
}

TEST_F(Work, Simplification) {
  const Simplification result = count([&] { return work_simplify(city); });
  expect_work("simplify.geos_operations", static_cast<double>(counted.geos_operations));
  expect_work("simplify.rounds", result.stats.rounds);
}

TEST_F(Work, GroundMesh) {
  const GroundMesh mesh = count([&] { return work_ground(city); });
  double corners = 4;
  for (const Polygon& footprint : city.input->footprints) {
    corners += static_cast<double>(footprint.outer.size());
    for (const Ring& hole : footprint.holes) corners += static_cast<double>(hole.size());
  }
  expect_work("ground.triangles", static_cast<double>(mesh.triangles.size()));
  expect_work("ground.added_vertices", static_cast<double>(mesh.vertices.size()) - corners);
  // What moving vertices after the refinement is for.
  double thin = 0;
  for (const auto& triangle : mesh.triangles) thin += smallest_angle_deg(mesh, triangle) < 36;
  expect_work("ground.triangles_below_36_degrees", thin);
  expect_work("ground.exact_orientations", static_cast<double>(counted.exact_orientations));
  expect_work("ground.exact_circles", static_cast<double>(counted.exact_circles));
  expect_allocations("ground");
  expect_bytes_per("ground", "triangle", static_cast<double>(mesh.triangles.size()));
}

TEST_F(Work, Columns) {
  const ColumnMesh mesh = count([&] { return work_columns(city, ground); });
  expect_work("columns.cells", cells_of(mesh));
  expect_allocations("columns");
  expect_bytes_per("columns", "cell", cells_of(mesh));
}

TEST_F(Work, UniformLayers) {
  const UniformResult result = count([&] { return work_uniform(city, ground); });
  ASSERT_TRUE(result.ground.converged && result.roofs.converged);
  expect_work("uniform.iterations_to_ground", result.ground.iterations);
  expect_work("uniform.iterations_to_roofs", result.roofs.iterations);
  expect_allocations("uniform");
  expect_bytes_per("uniform", "node", static_cast<double>(result.nodes));
}

TEST_F(Work, Quality) {
  const ColumnMesh mesh = work_columns(city, ground);
  count([&] { return work_quality(mesh); });
  expect_allocations("quality");
}

TEST_F(Work, Boundary) {
  const ColumnMesh mesh = work_columns(city, ground);
  const SurfaceMesh boundary = count([&] { return work_boundary(mesh); });
  expect_work("boundary.triangles", static_cast<double>(boundary.triangles.size()));
  expect_allocations("boundary");
  expect_bytes_per("boundary", "triangle", static_cast<double>(boundary.triangles.size()));
}

TEST_F(Work, Writing) {
  const ColumnMesh mesh = work_columns(city, ground);
  const SurfaceMesh boundary = work_boundary(mesh);
  const TemporaryFolder folder;
  const std::int64_t bytes =
      count([&] { return work_write(mesh, boundary, folder.path().string()); });
  expect_work("write.bytes", static_cast<double>(bytes));
  expect_allocations("write");
  expect_bytes_per("write", "cell", cells_of(mesh));
}

}  // namespace
}  // namespace tetropolis::testing
