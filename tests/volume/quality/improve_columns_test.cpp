#include "volume/quality/improve_columns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "support/explicit_mesh.h"
#include "support/small_city.h"
#include "support/spoilt_mesh.h"
#include "support/test_data.h"
#include "support/tet_shape.h"

namespace tetropolis {
namespace {

/// The header's sum over all cells, from explicit lists.
double total_cost(const ColumnMesh& mesh, const ImproveOptions& options) {
  const auto excess = [](double wanted, double got) {
    return got < wanted ? std::pow(wanted / got, 2) - 1 : 0;
  };
  const auto lists = testing::explicit_mesh(mesh);
  const double radians = std::numbers::pi / 180;
  double sum = 0;
  for (const auto& cell : lists.cells) {
    const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(cell[i])]; };
    const testing::TetShape shape = testing::tet_shape(p(0), p(1), p(2), p(3));
    sum += excess(1 - std::cos(options.least_deg * radians),
                  1 - std::cos(shape.min_dihedral_deg * radians));
    sum += excess(1 + std::cos(options.greatest_deg * radians),
                  1 + std::cos(shape.max_dihedral_deg * radians));
    if (shape.min_dihedral_deg < kQualityFloor.least ||
        shape.max_dihedral_deg > kQualityFloor.greatest)
      sum += 100;
  }
  return sum;
}

/// Faces are shared by two cells or lie on the boundary, each once as seen from either side.
void expect_conforming(const ColumnMesh& mesh) {
  std::map<std::array<std::int64_t, 3>, int> faces;
  for (const auto& cell : testing::explicit_mesh(mesh).cells)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::array<std::int64_t, 3> face{};
      for (std::size_t i = 0, n = 0; i < 4; ++i)
        if (i != skip) face[n++] = cell[i];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  for (const auto& [face, count] : faces) EXPECT_LE(count, 2);
}

/// Ground, roof and top of every column.
std::vector<std::array<double, 3>> fixed_heights(const ColumnMesh& mesh) {
  std::vector<std::array<double, 3>> heights;
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    const auto at = [&](NodeIndex n) { return mesh.z[n]; };
    heights.push_back({at(mesh.first[v]), at(mesh.first[v] + std::ranges::max(mesh.floors_at(v))),
                       at(mesh.first[v + 1] - 1)});
  }
  return heights;
}

TEST(ImproveColumns, RepairsSpoiltColumnsAndKeepsSurfaces) {
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    const ColumnMesh good = testing::meshed(testing::small_city(terrain)).mesh;
    for (const double share : {0.06, 0.3}) {
      SCOPED_TRACE(share);
      const ColumnMesh before = testing::spoilt(good, share);
      ColumnMesh after = before;
      const auto changed = static_cast<std::int64_t>(improve_columns(after).columns.size());
      EXPECT_GT(changed, 0) << "seed " << testing::test_seed();
      require_valid(after);
      expect_conforming(after);
      EXPECT_EQ(fixed_heights(after), fixed_heights(before));
      // What was spoilt gets better by far; cells that were bad before may have to stay so.
      const ImproveOptions options;
      const double least = total_cost(good, options), most = total_cost(before, options);
      EXPECT_GT(most, least);
      EXPECT_LT(total_cost(after, options) - least, 0.1 * (most - least))
          << "seed " << testing::test_seed();
      EXPECT_GE(measure_cells(after).histogram.min_dihedral_deg(),
                measure_cells(before).histogram.min_dihedral_deg());
      std::int64_t differ = 0;
      for (const VertexIndex v : before.ground.vertices.indices())
        differ += testing::column(before, v) != testing::column(after, v);
      EXPECT_LE(differ, changed);
      EXPECT_GT(differ, 0);
    }
  }
}

/// The sums that changes are judged by are those of the whole mesh, and neighbours do not change
/// under each other's hands: every sweep that changes anything lowers the total, down to the last.
TEST(ImproveColumns, EverySweepLowersTheTotal) {
  ImproveOptions options;
  options.least_deg = 25;  // more than there is to be had everywhere
  options.sweeps = 1;
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    ColumnMesh mesh = testing::spoilt(testing::meshed(testing::small_city(terrain)).mesh, 0.5);
    double total = total_cost(mesh, options);
    std::int64_t changed = 1;
    for (int sweep = 0; changed > 0 && sweep < 25; ++sweep) {
      changed = static_cast<std::int64_t>(improve_columns(mesh, options).columns.size());
      const double then = total_cost(mesh, options);
      if (changed > 0) {
        EXPECT_LT(then, total) << "sweep " << sweep << " seed " << testing::test_seed();
      } else {
        EXPECT_EQ(then, total);
      }
      total = then;
    }
  }
}

TEST(ImproveColumns, StraightensFacesWhereAsked) {
  std::int64_t before = 0, without = 0, with = 0;
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    const ColumnMesh mesh =
        testing::spoilt(testing::meshed(testing::small_city(terrain)).mesh, 0.3);
    before += measure_faces(mesh).above_70;
    for (const double straight : {90.0, 68.0}) {
      ImproveOptions options;
      options.straight_deg = straight;
      ColumnMesh after = mesh;
      improve_columns(after, options);
      require_valid(after);
      expect_conforming(after);
      EXPECT_EQ(fixed_heights(after), fixed_heights(mesh));
      (straight < 90 ? with : without) += measure_faces(after).above_70;
    }
  }
  EXPECT_GT(without, 0) << testing::test_seed();
  EXPECT_LT(without, before) << testing::test_seed();
  EXPECT_LT(with, without / 2) << testing::test_seed();
}

TEST(ImproveColumns, NodesDoNotBecomeFurtherApartThanTheyMay) {
  const ColumnMesh before =
      testing::spoilt(testing::meshed(testing::small_city(testing::hills)).mesh, 0.3);
  const auto pairs_over = [](const ColumnMesh& mesh, VertexIndex v, double gap) {
    std::set<std::pair<double, double>> pairs;  // of neighbouring nodes, further apart
    for (NodeIndex n = mesh.first[v]; n + 1 < mesh.first[v + 1]; n = n + 1)
      if (mesh.z[n + 1] - mesh.z[n] > gap) pairs.emplace(mesh.z[n], mesh.z[n + 1]);
    return pairs;
  };
  // How many there are that were not before.
  const auto wider = [&](const ColumnMesh& after, double gap) {
    int count = 0;
    for (const VertexIndex v : after.ground.vertices.indices()) {
      const auto old = pairs_over(before, v, gap);
      for (const auto& pair : pairs_over(after, v, gap)) count += old.contains(pair) ? 0 : 1;
    }
    return count;
  };
  ImproveOptions options;
  ColumnMesh free = before, bounded = before;
  improve_columns(free, options);
  options.most_gap = 9;
  EXPECT_GT(improve_columns(bounded, options).columns.size(), 0U);
  EXPECT_GT(wider(free, options.most_gap), 0) << "seed " << testing::test_seed();
  EXPECT_EQ(wider(bounded, options.most_gap), 0) << "seed " << testing::test_seed();
}

TEST(ImproveColumns, LeavesWhatIsGoodAlone) {
  const ColumnMesh before = testing::meshed(testing::small_city(testing::hills)).mesh;
  ImproveOptions options;
  options.least_deg = measure_cells(before).histogram.min_dihedral_deg() - 1e-6;
  options.greatest_deg = measure_cells(before).histogram.max_dihedral_deg() + 1e-6;
  ColumnMesh after = before;
  EXPECT_TRUE(improve_columns(after, options).columns.empty());
  EXPECT_EQ(after.z, before.z);
  EXPECT_EQ(after.first, before.first);
  EXPECT_EQ(after.floors, before.floors);
}

TEST(ImproveColumns, ColumnsFarFromBadCellsStay) {
  ColumnMesh before = testing::meshed(testing::small_city(testing::hills)).mesh;
  // One node far out of place, on a column of its own.
  const VertexIndex moved(
      std::min_element(before.ground.vertices.begin(), before.ground.vertices.end(),
                       [](Point2 a, Point2 b) {
                         return std::hypot(a.x - 60, a.y - 82) < std::hypot(b.x - 60, b.y - 82);
                       }) -
      before.ground.vertices.begin());
  double* z = before.z.data() + before.first[moved];
  z[2] = z[1] + 0.05 * (z[3] - z[1]);
  ColumnMesh after = before;
  EXPECT_FALSE(improve_columns(after).columns.empty());
  EXPECT_NE(testing::column(after, moved), testing::column(before, moved));
  const Point2 at = before.ground.vertices[moved];
  for (const VertexIndex v : before.ground.vertices.indices()) {
    const Point2 p = before.ground.vertices[v];
    if (std::hypot(p.x - at.x, p.y - at.y) < 25) continue;
    EXPECT_EQ(testing::column(after, v), testing::column(before, v));
  }
}

/// Faces are made straight at the price of better cells, never of cells below the floor.
TEST(ImproveColumns, NothingIsGainedAtThePriceOfTheFloor) {
  ImproveOptions options;
  options.least_deg = 1;
  options.greatest_deg = 179;
  options.straight_deg = 30;  // less than there is to be had
  options.sweeps = 1;
  for (const auto& [name, terrain] : testing::kHardTerrains) {
    SCOPED_TRACE(name);
    ColumnMesh mesh = testing::meshed(testing::small_city(terrain)).mesh;
    const std::int64_t bad = testing::count_bad_cells(mesh, kQualityFloor);
    EXPECT_FALSE(improve_columns(mesh, options).columns.empty());
    EXPECT_LE(testing::count_bad_cells(mesh, kQualityFloor), bad);
  }
}

TEST(ImproveColumns, WorksNearTheTrianglesItIsGiven) {
  const ColumnMesh before =
      testing::spoilt(testing::meshed(testing::small_city(testing::hills)).mesh, 0.5);
  std::vector<std::uint8_t> west(before.triangle_count(), 0);
  const auto is_west = [&](VertexIndex v) {
    return before.ground.vertices[static_cast<std::size_t>(v)].x < 30;
  };
  for (std::size_t t = 0; t < west.size(); ++t) {
    const auto& v = before.ground.triangles[t];
    west[t] = is_west(v[0]) && is_west(v[1]) && is_west(v[2]) ? 1 : 0;
  }
  ImproveOptions options;
  options.near = west;
  options.sweeps = 1;
  ColumnMesh after = before;
  EXPECT_FALSE(improve_columns(after, options).columns.empty());
  std::int64_t changed_in_the_west = 0;
  for (const VertexIndex v : before.ground.vertices.indices()) {
    if (testing::column(before, v) == testing::column(after, v)) continue;
    EXPECT_LT(before.ground.vertices[v].x, 30 + 2 * 8);
    changed_in_the_west += before.ground.vertices[v].x < 30 ? 1 : 0;
  }
  EXPECT_GT(changed_in_the_west, 0);
}

TEST(ImproveColumns, LooksAtNoMoreCellsThanItMay) {
  const ColumnMesh before =
      testing::spoilt(testing::meshed(testing::small_city(testing::hills)).mesh, 0.5);
  ImproveOptions options;
  ColumnMesh after = before;
  const Improvement all = improve_columns(after, options);
  for (const std::int64_t part : {2, 5, 20}) {
    options.most_cells = all.cells / part;
    after = before;
    const Improvement some = improve_columns(after, options);
    // What a column has begun is finished.
    EXPECT_LT(some.cells, options.most_cells + all.cells / 4);
  }
  options.most_cells = 0;
  after = before;
  EXPECT_TRUE(improve_columns(after, options).columns.empty());
  EXPECT_EQ(after.z, before.z);
}

TEST(ImproveColumns, GivesTheSameBitsForAnyNumberOfThreads) {
  const ColumnMesh before =
      testing::spoilt(testing::meshed(testing::small_city(testing::hills)).mesh, 0.5);
  std::vector<ColumnMesh> meshes;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    meshes.push_back(before);
    improve_columns(meshes.back());
  }
  for (const ColumnMesh& mesh : meshes) {
    EXPECT_EQ(mesh.z, meshes[0].z);
    EXPECT_EQ(mesh.first, meshes[0].first);
  }
}

TEST(ImproveColumns, StopsWhenAsked) {
  ColumnMesh mesh = testing::spoilt(testing::meshed(testing::small_city(testing::hills)).mesh, 0.5);
  const std::vector<double> before = mesh.z;
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(improve_columns(mesh, {}, progress), Cancelled);
  EXPECT_EQ(mesh.z, before);
}

}  // namespace
}  // namespace tetropolis
