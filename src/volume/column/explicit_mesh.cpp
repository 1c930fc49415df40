#include "tetropolis/volume/column/explicit_mesh.h"

#include <algorithm>

#include "core/parallel.h"
#include "internal_faces.h"
#include "prism_faces.h"
#include "upper_faces.h"

namespace tetropolis {

namespace {

constexpr std::size_t kGrain = 4096;

/// Calls body(row, first, last) for the rows [begin, end), in parallel: their cells are those of
/// the part from `first` to `last` - 1.
template <typename Body>
void for_each_row(const std::vector<CellIndex>& offsets, std::size_t begin, std::size_t end,
                  const Body& body) {
  const auto position = [&](std::size_t row) {
    return static_cast<std::size_t>(offsets[row] - offsets[begin]);
  };
  parallel_chunks(end - begin, kGrain, [&](std::size_t from, std::size_t to) {
    for (std::size_t row = begin + from; row < begin + to; ++row)
      body(row, position(row), position(row + 1));
  });
}

}  // namespace

void fill_points(const ColumnMesh& mesh, const Point3& shift,
                 std::span<std::array<double, 3>> points) {
  parallel_chunks(point_rows(mesh), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for_each_point_of(mesh, row, [&](NodeIndex n, const Point3& p) {
        points[n] = {p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]};
      });
  });
}

void fill_cells(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                std::size_t end, std::span<std::array<NodeIndex, 4>> cells) {
  for_each_row(offsets, begin, end, [&](std::size_t row, std::size_t first, std::size_t) {
    for_each_tet_of(mesh, row, [&](const std::array<NodeIndex, 4>& tet) { cells[first++] = tet; });
  });
}

void fill_regions(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                  std::size_t end, std::span<BuildingIndex> regions) {
  for_each_row(offsets, begin, end, [&](std::size_t row, std::size_t first, std::size_t last) {
    std::fill(regions.begin() + static_cast<std::ptrdiff_t>(first),
              regions.begin() + static_cast<std::ptrdiff_t>(last), building_below(mesh, row));
  });
}

void fill_wedges(const ColumnMesh& mesh, std::span<std::array<NodeIndex, 6>> wedges) {
  parallel_chunks(wedges.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) wedges[i] = wedge(mesh, static_cast<std::int64_t>(i));
  });
}

std::vector<CellFace> internal_faces(const ColumnMesh& mesh) {
  std::vector<CellFace> faces;
  const auto add = [&](CellIndex owner, CellIndex neighbour, const std::array<NodeIndex, 3>& n) {
    faces.push_back({owner, neighbour, {n[0], n[1], n[2], {}}});
  };
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  InternalFaces in_columns(mesh, cells);
  for (const TriangleIndex t : mesh.ground.triangles.indices())
    for (const InternalFace& face : in_columns.owned_over(t))
      add(face.owner, face.neighbour, face.nodes);
  const CellIndex first = cells[mesh.triangle_count()];
  if (!mesh.upper.empty())
    for (const UpperFace& face : upper_faces(mesh))
      add(first + face.cell, first + face.neighbour, upper_nodes(mesh, face.places));
  const std::vector<CellFace> between_prisms = prism_faces(mesh, cells.back());
  faces.insert(faces.end(), between_prisms.begin(), between_prisms.end());
  return faces;
}

}  // namespace tetropolis
