// check_volume against plain computations with maps and sorted lists, on good and broken meshes.
#include "tetropolis/check/check_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/explicit_mesh.h"
#include "tetropolis/volume/quality/face_quality.h"
#include "tetropolis/volume/quality/prism_quality.h"

#include "check/check_same_boundary.h"
#include "core/parallel.h"
#include "support/explicit_mesh.h"
#include "support/prism_city.h"
#include "support/small_city.h"
#include "support/test_data.h"
#include "support/tet_shape.h"

namespace tetropolis {
namespace {

class CheckVolume : public ::testing::Test {
 protected:
  testing::MeshedCity city = testing::meshed(testing::small_city(testing::hills), 12);
  TetMesh mesh;
  std::mt19937 random{testing::test_seed()};

  void SetUp() override {
    RecordProperty("seed", static_cast<int>(testing::test_seed()));
    const auto lists = testing::explicit_mesh(city.mesh);
    mesh = {lists.points, lists.cells, lists.region};
  }
  testing::TetShape shape(std::size_t c) const {
    const auto p = [&](std::size_t i) {
      return mesh.points[static_cast<std::size_t>(mesh.cells[c][i])];
    };
    return testing::tet_shape(p(0), p(1), p(2), p(3));
  }
  std::size_t any_cell() {
    return std::uniform_int_distribution<std::size_t>(0, mesh.cells.size() - 1)(random);
  }
};

std::map<std::string, std::int64_t> counts(const std::vector<Violation>& violations) {
  std::map<std::string, std::int64_t> result;
  for (const Violation& v : violations) result[v.what] += v.count;
  return result;
}

/// Orders vertices and cells, and the vertices in cells, at random; cells stay positive.
TetMesh shuffled(const TetMesh& mesh, std::mt19937& random) {
  std::vector<std::size_t> number(mesh.points.size());
  std::iota(number.begin(), number.end(), std::size_t{0});
  std::shuffle(number.begin(), number.end(), random);
  TetMesh result{std::vector<std::array<double, 3>>(mesh.points.size()), mesh.cells, mesh.region};
  for (std::size_t v = 0; v < number.size(); ++v) result.points[number[v]] = mesh.points[v];
  std::shuffle(result.cells.begin(), result.cells.end(), random);
  for (auto& cell : result.cells) {
    for (auto& v : cell) v = static_cast<std::int64_t>(number[static_cast<std::size_t>(v)]);
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::shuffle(order.begin(), order.end(), random);
    int swaps = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) swaps += order[i] > order[j] ? 1 : 0;
    if (swaps % 2 == 1) std::swap(order[2], order[3]);
    cell = {cell[order[0]], cell[order[1]], cell[order[2]], cell[order[3]]};
  }
  return result;
}

TEST_F(CheckVolume, QuantilesAreThoseOfTheSortedCells) {
  std::vector<double> angles, aspects;
  std::int64_t slivers = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    angles.push_back(shape(c).min_dihedral_deg);
    aspects.push_back(shape(c).aspect_ratio);
    slivers += angles.back() < kSliverDihedralDeg ? 1 : 0;
  }
  std::sort(angles.begin(), angles.end());
  std::sort(aspects.begin(), aspects.end());
  const auto at = [&](const std::vector<double>& sorted, double share) {
    std::size_t rank = 0;
    while (static_cast<double>(rank + 1) < share * static_cast<double>(sorted.size())) ++rank;
    return sorted[rank];
  };
  const VolumeCheck check = check_volume(mesh);
  const Distribution& angle = check.min_dihedral_deg;
  const Distribution& aspect = check.aspect_ratio;
  const std::array<double, 7> shares{0, 1e-4, 1e-3, 1e-2, 0.5, 0.99, 1};
  const std::array<double, 7> found{angle.min,    angle.p0_01, angle.p0_1, angle.p1,
                                    angle.median, angle.p99,   angle.max};
  const std::array<double, 7> found_aspect{aspect.min,    aspect.p0_01, aspect.p0_1, aspect.p1,
                                           aspect.median, aspect.p99,   aspect.max};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(found[i], at(angles, shares[i]), 1e-5) << shares[i];
    EXPECT_NEAR(found_aspect[i] / at(aspects, shares[i]), 1, 1e-6) << shares[i];
  }
  EXPECT_EQ(check.slivers, slivers);
  // With cells squeezed to a tenth of their height there are slivers to count.
  for (auto& p : mesh.points) p[2] /= 10;
  slivers = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    slivers += shape(c).min_dihedral_deg < kSliverDihedralDeg ? 1 : 0;
  EXPECT_GT(slivers, 100);
  EXPECT_EQ(check_volume(mesh).slivers, slivers);
}

TEST_F(CheckVolume, FacesHaveTheShapeThatTheGeneratorMeasures) {
  const FaceQuality expected = measure_faces(city.mesh);
  const FaceMeasures found = check_volume(mesh).faces;
  EXPECT_EQ(found.internal, expected.faces);
  EXPECT_EQ(found.above_70, expected.above_70);
  EXPECT_NEAR(found.max_non_orthogonality_deg, expected.worst.non_orthogonality_deg, 1e-6);
  EXPECT_NEAR(found.max_skewness, expected.worst.skewness, 1e-9);
  EXPECT_GT(found.mean_non_orthogonality_deg, 0);
  EXPECT_LT(found.mean_non_orthogonality_deg, found.max_non_orthogonality_deg);
}

TEST_F(CheckVolume, TwoTetsWithAKnownFace) {
  // As in the test of face_shape: the centres are 45 degrees off the normal of the face between
  // them, and the line between them passes 1 m beside the face's centre.
  TetMesh two;
  two.points = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {-7, 1, -4}, {1, 1, 4}};
  two.cells = {{0, 2, 1, 3}, {0, 1, 2, 4}};
  const VolumeCheck check = check_volume(two);
  EXPECT_EQ(counts(check.violations), (std::map<std::string, std::int64_t>{}));
  EXPECT_EQ(check.boundary_faces, 6);
  EXPECT_EQ(check.faces.internal, 1);
  EXPECT_NEAR(check.faces.max_non_orthogonality_deg, 45, 1e-9);
  EXPECT_NEAR(check.faces.mean_non_orthogonality_deg, 45, 1e-9);
  EXPECT_NEAR(check.faces.max_skewness, 0.5, 1e-12);
}

TEST_F(CheckVolume, TheOrderOfVerticesAndCellsDoesNotMatter) {
  const VolumeCheck straight = check_volume(mesh);
  const VolumeCheck check = check_volume(shuffled(mesh, random));
  EXPECT_EQ(counts(check.violations), counts(straight.violations)) << testing::test_seed();
  EXPECT_EQ(check.boundary_faces, straight.boundary_faces);
  EXPECT_EQ(check.faces.internal, straight.faces.internal);
  EXPECT_NEAR(check.volume, straight.volume, 1e-9 * straight.volume);
  EXPECT_NEAR(check.faces.max_skewness, straight.faces.max_skewness, 1e-9);
  EXPECT_NEAR(check.min_dihedral_deg.min, straight.min_dihedral_deg.min, 1e-5);
}

/// Faces of cells by their sorted vertices, each with how often it occurs in either orientation.
std::map<std::array<std::int64_t, 3>, std::array<std::int64_t, 2>> count_faces(
    const TetMesh& mesh) {
  constexpr std::array<std::array<std::size_t, 3>, 4> outward{
      {{{1, 2, 3}}, {{0, 3, 2}}, {{0, 1, 3}}, {{0, 2, 1}}}};
  std::map<std::array<std::int64_t, 3>, std::array<std::int64_t, 2>> faces;
  for (const auto& cell : mesh.cells)
    for (const auto& corners : outward) {
      std::array<std::int64_t, 3> v{cell[corners[0]], cell[corners[1]], cell[corners[2]]};
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      const std::size_t side = v[1] < v[2] ? 0 : 1;
      std::sort(v.begin(), v.end());
      ++faces[v][side];
    }
  return faces;
}

TEST_F(CheckVolume, FacesOfBrokenMeshesAreMatchedAsAMapMatchesThem) {
  mesh = shuffled(mesh, random);
  for (int i = 0; i < 20; ++i) {
    mesh.cells.push_back(mesh.cells[any_cell()]);                // twice
    std::swap(mesh.cells[any_cell()][1], mesh.cells.back()[2]);  // torn
    auto& turned = mesh.cells[any_cell()];
    std::swap(turned[0], turned[3]);
    mesh.cells.erase(mesh.cells.begin() + static_cast<std::ptrdiff_t>(any_cell()));
  }
  // Cells with a vertex twice have no faces to speak of.
  std::erase_if(mesh.cells, [](const auto& cell) {
    return std::set<std::int64_t>(cell.begin(), cell.end()).size() < 4;
  });
  std::int64_t many = 0, overlapping = 0, internal = 0;
  std::set<std::array<std::int64_t, 3>> boundary;
  for (const auto& [face, uses] : count_faces(mesh)) {
    if (uses[0] + uses[1] == 1)
      boundary.insert(uses[0] == 1 ? face : std::array{face[0], face[2], face[1]});
    else if (uses[0] + uses[1] > 2)
      ++many;
    else if (uses[0] != 1)
      ++overlapping;
    else
      ++internal;
  }
  EXPECT_GT(many, 0);
  EXPECT_GT(overlapping, 0);
  std::vector<Violation> first;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const VolumeCheck check = check_volume(mesh);
    auto found = counts(check.violations);
    EXPECT_EQ(found["faces of more than two cells"], many) << testing::test_seed();
    EXPECT_EQ(found["neighbouring cells that overlap"], overlapping) << testing::test_seed();
    EXPECT_EQ(check.faces.internal, internal);
    EXPECT_EQ(std::set(check.boundary.begin(), check.boundary.end()), boundary);
    EXPECT_EQ(check.boundary.size(), boundary.size());
    if (threads == 1) first = check.violations;
    ASSERT_EQ(first.size(), check.violations.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(first[i].what, check.violations[i].what);
      EXPECT_EQ(first[i].first, check.violations[i].first);
    }
  }
}

TEST_F(CheckVolume, FlatCellsAndCellsWithAVertexTwiceAreInverted) {
  auto& twice = mesh.cells[any_cell()];
  twice[0] = twice[2];
  const VolumeCheck check = check_volume(mesh);
  EXPECT_EQ(check.inverted, 1);
  EXPECT_EQ(check.min_dihedral_deg.min, 0);
  EXPECT_TRUE(std::isinf(check.aspect_ratio.max));
}

TEST_F(CheckVolume, CoincidentVerticesAreCountedWhereverTheyAre) {
  std::set<std::size_t> copied;
  while (copied.size() < 30)
    copied.insert(std::uniform_int_distribution<std::size_t>(0, mesh.points.size() - 1)(random));
  for (const std::size_t v : copied) mesh.points.push_back(mesh.points[v]);
  mesh.points.push_back({1e12, -1e12, 0});  // all others in one square of any grid
  auto found = counts(check_volume(mesh).violations);
  EXPECT_EQ(found["coincident vertices"], 30) << testing::test_seed();
  EXPECT_EQ(found["vertices without cells"], 31);
}

TEST_F(CheckVolume, FacesMissingFromOneSideOnlyAreCounted) {
  const VolumeCheck check = check_volume(mesh);
  SurfaceMesh surface = extract_boundary(city.mesh);
  const auto odd = [&](const SurfaceMesh& other) {
    std::int64_t sum = 0;
    for (const Violation& v : check_same_boundary(mesh, check, other)) sum += v.count;
    return sum;
  };
  EXPECT_EQ(odd(surface), 0);
  surface.triangles.push_back(surface.triangles[5]);
  EXPECT_EQ(odd(surface), 1);
  surface.triangles.erase(surface.triangles.begin() + 9, surface.triangles.begin() + 12);
  EXPECT_EQ(odd(surface), 4);
  EXPECT_EQ(odd({}), check.boundary_faces);
}

/// A list that counts how often one with something in it is copied.
struct CountedList {
  static inline int copies = 0;
  std::vector<std::size_t> items;

  CountedList() = default;
  explicit CountedList(std::size_t item) : items{item} {}
  CountedList(const CountedList& other) : items(other.items) { copies += items.empty() ? 0 : 1; }
  CountedList(CountedList&&) = default;
  CountedList& operator=(CountedList&&) = default;
  CountedList& operator=(const CountedList&) = delete;
};

/// Broken meshes make long lists: copied with every chunk, they took quadratic time.
TEST(CheckReduction, WhatIsGatheredIsNotCopied) {
  CountedList::copies = 0;
  const CountedList all = parallel_reduce_ordered(
      1000, 1, CountedList{}, [](std::size_t begin, std::size_t) { return CountedList(begin); },
      [](CountedList sum, const CountedList& part) {
        sum.items.insert(sum.items.end(), part.items.begin(), part.items.end());
        return sum;
      });
  EXPECT_EQ(CountedList::copies, 0);
  ASSERT_EQ(all.items.size(), 1000U);
  EXPECT_TRUE(std::is_sorted(all.items.begin(), all.items.end()));
}

/// Tets and prisms of the small city, as read back.
TetMesh with_prisms(const ColumnMesh& columns) {
  TetMesh mesh;
  mesh.points.resize(static_cast<std::size_t>(columns.node_count()));
  fill_points(columns, {0, 0, 0}, mesh.points);
  mesh.cells = testing::explicit_mesh(columns).cells;
  for (std::int64_t i = 0; i < columns.layers.cells(); ++i) {
    auto& own = mesh.wedges.emplace_back();
    const auto nodes = wedge(columns, i);
    for (std::size_t k = 0; k < nodes.size(); ++k) own[k] = nodes[k].value();
  }
  return mesh;
}

class CheckPrisms : public ::testing::Test {
 protected:
  testing::MeshedCity city =
      testing::prism_city(testing::small_city(testing::hills), 12, {5, 0.5, 1.2});
  TetMesh mesh = with_prisms(city.mesh);
};

TEST_F(CheckPrisms, FindsWhatTheMeshSays) {
  const VolumeCheck check = check_volume(mesh);
  EXPECT_EQ(counts(check.violations), (std::map<std::string, std::int64_t>{}));
  const PrismQuality prisms = measure_prisms(city.mesh, 0.5);
  const FaceQuality faces = measure_faces(city.mesh);
  EXPECT_EQ(check.prisms.cells, prisms.cells);
  EXPECT_EQ(check.cells, std::ssize(mesh.cells) + prisms.cells);
  EXPECT_NEAR(check.prisms.max_aspect_ratio, prisms.max_aspect_ratio, 1e-9);
  EXPECT_NEAR(check.prisms.least_flatness, 1, 1e-12);
  EXPECT_EQ(check.faces.internal, faces.faces + prisms.faces);
  EXPECT_EQ(check.faces.above_70, faces.above_70 + prisms.above_70);
  EXPECT_NEAR(check.faces.max_non_orthogonality_deg,
              std::max(faces.worst.non_orthogonality_deg, prisms.max_non_orthogonality_deg), 1e-9);
  EXPECT_NEAR(check.faces.max_skewness, std::max(faces.worst.skewness, prisms.max_skewness), 1e-9);
  EXPECT_EQ(check.least_vertical_edge, require_valid(city.mesh));
  const SurfaceMesh boundary = extract_boundary(city.mesh);
  EXPECT_EQ(std::ssize(check.boundary_quads), std::ssize(boundary.quads));
  EXPECT_TRUE(check_same_boundary(mesh, check, boundary).empty());
}

TEST_F(CheckPrisms, FindsWhatIsBroken) {
  const auto with = [&](const auto& spoil) {
    TetMesh broken = mesh;
    spoil(broken);
    return counts(check_volume(broken).violations);
  };
  EXPECT_EQ(with([](TetMesh& m) {  // one corner below the one under it
              auto& w = m.wedges[7];
              m.points[static_cast<std::size_t>(w[3])][2] =
                  m.points[static_cast<std::size_t>(w[0])][2] - 0.01;
            })
                .count("inverted cells"),
            1U);
  EXPECT_EQ(
      with([](TetMesh& m) { m.wedges.erase(m.wedges.begin() + 7); }).count("open boundary edges"),
      0U);  // a hole is a boundary, too
  EXPECT_EQ(with([](TetMesh& m) {
              m.wedges.push_back(m.wedges[7]);
            }).count("faces of more than two cells"),
            1U);
  EXPECT_EQ(with([](TetMesh& m) {
              m.points[static_cast<std::size_t>(m.wedges[7][3])][0] += 0.01;
            }).count("prisms that are not upright"),
            1U);
  EXPECT_EQ(with([](TetMesh& m) {
              auto& w = m.wedges[7];
              w = {w[0], w[2], w[1], w[3], w[5], w[4]};
            }).count("neighbouring cells that overlap"),
            1U);
  // A boundary without one of its quadrilaterals, or with two triangles for it, is another one.
  const VolumeCheck check = check_volume(mesh);
  SurfaceMesh boundary = extract_boundary(city.mesh);
  boundary.quads.pop_back();
  EXPECT_EQ(counts(check_same_boundary(mesh, check, boundary)),
            (std::map<std::string, std::int64_t>{
                {"boundary faces in only one of volume and surface", 3}}));
}

}  // namespace
}  // namespace tetropolis
