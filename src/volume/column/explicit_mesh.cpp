#include "tetropolis/volume/column/explicit_mesh.h"

#include <algorithm>

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::size_t kGrain = 4096;

/// Calls body(t, first, last) for the triangles [begin, end), in parallel: their cells are those of
/// the part from `first` to `last` - 1.
template <typename Body>
void for_each_stack(const std::vector<CellIndex>& offsets, std::size_t begin, std::size_t end,
                    const Body& body) {
  const auto position = [&](TriangleIndex t) {
    return static_cast<std::size_t>(offsets[t] - offsets[begin]);
  };
  parallel_chunks(end - begin, kGrain, [&](std::size_t from, std::size_t to) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin + from, begin + to))
      body(t, position(t), position(t + 1));
  });
}

}  // namespace

void fill_points(const ColumnMesh& mesh, const Point3& shift,
                 std::span<std::array<double, 3>> points) {
  parallel_chunks(mesh.vertex_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      const Point2 p = mesh.ground.vertices[v];
      for (const NodeIndex n : mesh.nodes(v))
        points[n] = {p.x + shift[0], p.y + shift[1], mesh.z[n] + shift[2]};
    }
  });
}

void fill_cells(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                std::size_t end, std::span<std::array<NodeIndex, 4>> cells) {
  for_each_stack(offsets, begin, end, [&](TriangleIndex t, std::size_t first, std::size_t) {
    for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& tet) { cells[first++] = tet; });
  });
}

void fill_regions(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                  std::size_t end, std::span<BuildingIndex> regions) {
  for_each_stack(offsets, begin, end, [&](TriangleIndex t, std::size_t first, std::size_t last) {
    std::fill(regions.begin() + static_cast<std::ptrdiff_t>(first),
              regions.begin() + static_cast<std::ptrdiff_t>(last),
              mesh.ground.region_of(t).building);
  });
}

}  // namespace tetropolis
