#include "tetropolis/volume/column/explicit_mesh.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/explicit_mesh.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

TEST(ExplicitMesh, IsTheListMadeThePlainWay) {
  const ColumnMesh mesh = testing::meshed(testing::small_city(testing::hills)).mesh;
  const Point3 shift{1000, -2000, 3};
  const testing::ExplicitMesh plain = testing::explicit_mesh(mesh, shift);
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  ASSERT_EQ(static_cast<std::size_t>(offsets.back().value()), plain.cells.size());

  std::vector<std::array<double, 3>> points(static_cast<std::size_t>(mesh.node_count()));
  fill_points(mesh, shift, points);
  EXPECT_EQ(points, plain.points);

  // The whole, and parts of it that begin and end anywhere.
  const std::size_t triangles = mesh.triangle_count();
  using Part = std::pair<std::size_t, std::size_t>;
  for (const Part& part : {Part{0, triangles}, Part{triangles / 3, triangles - 7},
                           Part{triangles - 1, triangles}, Part{5, 5}}) {
    const auto first = static_cast<std::size_t>(offsets[part.first].value());
    const auto last = static_cast<std::size_t>(offsets[part.second].value());
    std::vector<std::array<NodeIndex, 4>> cells(last - first);
    std::vector<BuildingIndex> regions(last - first);
    fill_cells(mesh, offsets, part.first, part.second, cells);
    fill_regions(mesh, offsets, part.first, part.second, regions);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      for (std::size_t i = 0; i < 4; ++i)
        ASSERT_EQ(cells[c][i].value(), plain.cells[first + c][i]) << "cell " << first + c;
      ASSERT_EQ(regions[c].value(), plain.region[first + c]) << "cell " << first + c;
    }
  }
}

}  // namespace
}  // namespace tetropolis
