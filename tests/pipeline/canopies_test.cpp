// Zones of cells against every cell's own centroid, polygon by polygon.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/volume/column/explicit_mesh.h"

#include "pipeline/canopy_heights.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

/// The turns that a ring makes around a point: 0 outside.
int turns(const Ring& ring, Point2 p) {
  double angle = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a{ring[i].x - p.x, ring[i].y - p.y};
    const Point2 next = ring[(i + 1) % ring.size()];
    const Point2 b{next.x - p.x, next.y - p.y};
    angle += std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
  }
  return static_cast<int>(std::lround(std::abs(angle) / (2 * std::numbers::pi)));
}

/// Elevation of the boundary's faces of the ground at a place, if there is one.
std::optional<double> ground_at(const SurfaceMesh& boundary, Point2 p) {
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f) {
    if (boundary.patch[f] != Patch::kGround) continue;
    std::array<Point3, 3> c{};
    for (std::size_t i = 0; i < 3; ++i)
      c[i] = boundary.points[static_cast<std::size_t>(boundary.triangles[f][i])];
    const double twice =
        (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[1][1] - c[0][1]) * (c[2][0] - c[0][0]);
    const double s =
        ((p.x - c[0][0]) * (c[2][1] - c[0][1]) - (p.y - c[0][1]) * (c[2][0] - c[0][0])) / twice;
    const double t =
        ((c[1][0] - c[0][0]) * (p.y - c[0][1]) - (c[1][1] - c[0][1]) * (p.x - c[0][0])) / twice;
    if (std::min({s, t, 1 - s - t}) > -1e-9)
      return c[0][2] + s * (c[1][2] - c[0][2]) + t * (c[2][2] - c[0][2]);
  }
  return std::nullopt;
}

/// A box turned a little, across a building; another that it overlaps, with a clearing; one as high
/// as the highest columns; one of stems below its base; and one that is far away.
std::vector<Canopy> canopies() {
  std::vector<Canopy> all(5);
  all[0].area.outer = {{22.3, 28.1}, {52.7, 31.4}, {50.2, 46.9}, {20.6, 45.3}};
  all[0].height = 9.3;
  all[1].area.outer = {{3.1, 33.3}, {30.4, 35.2}, {31.1, 84.6}, {4.2, 82.7}};
  all[1].area.holes = {{{8.3, 60.2}, {8.9, 75.1}, {13.8, 74.4}, {12.6, 61.5}}};
  all[1].height = 14;
  all[1].leaf_area_density = 1.5;
  all[2].area.outer = {{62.2, 2.2}, {117.3, 3.4}, {115.9, 17.1}, {63.7, 15.2}};
  all[2].height = 75;
  all[3].area.outer = {{64.4, 64.2}, {115.2, 63.1}, {116.3, 87.3}, {66.1, 86.8}};
  all[3].height = 12.5;
  all[3].base = 4.1;
  all[4].area.outer = {{200, 200}, {210, 200}, {210, 210}};
  all[4].height = 10;
  return all;
}

CityMesh mesh_of(const testing::SmallCity& small, Cells cells, int layers, bool with) {
  MeshCityOptions options;
  options.mesh_size = 8;
  options.cells = cells;
  options.boundary_layers.count = layers;
  if (with) options.canopies = canopies();
  for (Canopy& canopy : options.canopies) {
    for (Point2& p : canopy.area.outer) p = {p.x + 1000, p.y + 2000};
    for (Ring& hole : canopy.area.holes)
      for (Point2& p : hole) p = {p.x + 1000, p.y + 2000};
  }
  return mesh_city(testing::city_model(small), small.dtm, options);
}

template <typename Nodes>
std::int32_t zone_of(const CityMesh& mesh, const std::vector<std::array<double, 3>>& points,
                     const Nodes& nodes, bool is_upper) {
  const auto count = static_cast<double>(nodes.size());
  Point3 centre{};
  double below = 0;
  for (const NodeIndex n : nodes) {
    const auto& p = points[std::size_t{n}];
    for (std::size_t c = 0; c < 3; ++c) centre[c] += p[c] / count;
    if (!is_upper) continue;
    const auto ground = ground_at(mesh.boundary, {p[0], p[1]});
    if (!ground) return 0;
    below += *ground / count;
  }
  const Point2 place{centre[0], centre[1]};
  if (!is_upper) {
    const auto ground = ground_at(mesh.boundary, place);
    if (!ground) return 0;
    below = *ground;
  }
  const double height = centre[2] - below;
  const std::vector<Canopy> all = canopies();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool in_hole = std::any_of(all[i].area.holes.begin(), all[i].area.holes.end(),
                                     [&](const Ring& hole) { return turns(hole, place) != 0; });
    if (turns(all[i].area.outer, place) != 0 && !in_hole && height > all[i].base &&
        height <= all[i].height)
      return static_cast<std::int32_t>(i) + 1;
  }
  return 0;
}

class Canopies : public ::testing::TestWithParam<std::pair<Cells, int>> {};

TEST_P(Canopies, HaveTheCellsWhoseCentroidIsInThem) {
  const auto [cells, layers] = GetParam();
  const testing::SmallCity city = testing::small_city(
      [](double x, double y) { return 3 + 2 * std::sin(x / 20) * std::cos(y / 25); });
  const CityMesh mesh = mesh_of(city, cells, layers, true);
  const std::vector<CellIndex> offsets = cell_offsets(mesh.volume);
  std::vector<std::array<double, 3>> points(static_cast<std::size_t>(mesh.volume.node_count()));
  fill_points(mesh.volume, {0, 0, 0}, points);
  std::vector<std::array<NodeIndex, 4>> tets(std::size_t{offsets.back()});
  fill_cells(mesh.volume, offsets, 0, offsets.size() - 1, tets);
  std::vector<std::array<NodeIndex, 6>> wedges(
      static_cast<std::size_t>(mesh.volume.layers.cells()));
  fill_wedges(mesh.volume, wedges);
  ASSERT_EQ(mesh.zones.of_cell.size(), tets.size() + wedges.size());
  const std::size_t upper = std::size_t{offsets[mesh.volume.triangle_count()]};
  std::vector<std::int64_t> counts(6, 0);
  std::int64_t of_upper = 0, wrong = 0;
  for (std::size_t c = 0; c < mesh.zones.of_cell.size(); ++c) {
    const std::int32_t zone = c < tets.size()
                                  ? zone_of(mesh, points, tets[c], c >= upper)
                                  : zone_of(mesh, points, wedges[c - tets.size()], false);
    wrong += zone == mesh.zones.of_cell[c] ? 0 : 1;
    ++counts[static_cast<std::size_t>(zone)];
    of_upper += zone != 0 && c < tets.size() && c >= upper ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  ASSERT_EQ(mesh.zones.zones.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const CellZone& zone = mesh.zones.zones[i];
    EXPECT_EQ(zone.name, "canopy_" + std::to_string(i + 1));
    EXPECT_EQ(zone.cells, counts[i + 1]);
    EXPECT_EQ(zone.cells > 20, i < 4) << i;
  }
  EXPECT_EQ(mesh.zones.zones[1].leaf_area_density, 1.5);
  EXPECT_EQ(of_upper > 0, cells == Cells::kTets);
  EXPECT_EQ(std::count_if(mesh.warnings.begin(), mesh.warnings.end(),
                          [](const Warning& w) {
                            return w.code == "canopy_without_cells" &&
                                   w.message.starts_with("1 canopies have no cell, the first, ");
                          }),
            1);
}

TEST_P(Canopies, LeaveTheMeshAsItIs) {
  const auto [cells, layers] = GetParam();
  const testing::SmallCity city = testing::small_city([](double, double) { return 2.0; });
  const CityMesh with = mesh_of(city, cells, layers, true);
  const CityMesh without = mesh_of(city, cells, layers, false);
  EXPECT_EQ(with.volume.z, without.volume.z);
  EXPECT_EQ(with.volume.layers.z, without.volume.layers.z);
  EXPECT_TRUE(without.zones.empty());
  EXPECT_TRUE(without.zones.of_cell.empty());
}

TEST(CanopyHeights, AreThoseOfTheHighestPointOfVegetationNearestToANode) {
  const Raster terrain =
      testing::raster_of({0, 0, 30, 20}, [](double x, double y) { return 5 + 0.1 * x - 0.2 * y; });
  PointCloud cloud;
  const std::size_t count = 800;
  for (auto* values : {&cloud.x, &cloud.y, &cloud.z}) values->resize(count);
  cloud.classification.resize(count);
  std::uint32_t state = 7;
  const auto next = [&](double most) {
    state = state * 1664525U + 1013904223U;
    return most * static_cast<double>(state >> 8U) / static_cast<double>(1U << 24U);
  };
  for (std::size_t p = 0; p < count; ++p) {
    cloud.x[p] = next(34) - 2;  // some beyond the terrain
    cloud.y[p] = next(24) - 2;
    cloud.z[p] = 5 + next(20);
    cloud.classification[p] = static_cast<std::uint8_t>(1 + p % 6);
  }
  const Raster heights = measure_canopies(cloud, terrain);
  ASSERT_EQ(heights.values.size(), terrain.values.size());
  std::int64_t measured = 0;
  for (std::int32_t j = 0; j < terrain.ny; ++j)
    for (std::int32_t i = 0; i < terrain.nx; ++i) {
      std::optional<double> highest;
      for (std::size_t p = 0; p < count; ++p) {
        const double x = cloud.x[p], y = cloud.y[p];
        if (cloud.classification[p] < 3 || cloud.classification[p] > 5 || std::abs(x - i) > 0.5 ||
            std::abs(y - j) > 0.5)
          continue;
        const double bx = std::clamp(x, 0.0, 30.0), by = std::clamp(y, 0.0, 20.0);
        const double height = cloud.z[p] - (5 + 0.1 * bx - 0.2 * by);
        highest = std::max(highest.value_or(height), height);
      }
      measured += highest ? 1 : 0;
      EXPECT_EQ(std::isnan(heights.at(i, j)), !highest);
      if (highest) {
        EXPECT_NEAR(heights.at(i, j), *highest, 1e-9);
      }
    }
  EXPECT_GT(measured, 200);
  std::fill(cloud.classification.begin(), cloud.classification.end(), kUnclassified);
  EXPECT_TRUE(measure_canopies(cloud, terrain).values.empty());
}

INSTANTIATE_TEST_SUITE_P(Of, Canopies,
                         ::testing::Values(std::pair(Cells::kTets, 0), std::pair(Cells::kTets, 4),
                                           std::pair(Cells::kPrisms, 4)));

}  // namespace
}  // namespace tetropolis
