// What the writers of volume formats share.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "io/file/chunked_output.h"

namespace tetropolis {

/// Appends x, y, z of the nodes of the rows [begin, end) of point_rows(), shifted, as raw doubles.
void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer);

/// Appends the nodes of the cells of the rows [begin, end) of `offsets`, which are cell_offsets(),
/// in the order of for_each_tet_of(), as raw numbers.
template <typename Integer>
void append_cells(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets, std::size_t begin,
                  std::size_t end, std::string& buffer) {
  const auto cells = static_cast<std::size_t>(offsets[end] - offsets[begin]);
  RawNumbers nodes(buffer, cells * 4 * sizeof(Integer));
  for (std::size_t row = begin; row < end; ++row)
    for_each_tet_of(mesh, row, [&](const std::array<NodeIndex, 4>& tet) {
      for (const NodeIndex node : tet) nodes.put(static_cast<Integer>(node.value()));
    });
}

/// Appends the building below each cell of the rows [begin, end) of cell_rows() (or kNoBuilding) as
/// raw 32-bit numbers.
void append_regions(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                    std::size_t begin, std::size_t end, std::string& buffer);

/// Calls visit(node, x, y, z) for the nodes of the rows [begin, end) of point_rows(), shifted.
template <typename Visit>
void for_each_point(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                    std::size_t end, const Visit& visit) {
  for (std::size_t row = begin; row < end; ++row)
    for_each_point_of(mesh, row, [&](NodeIndex n, const Point3& p) {
      visit(n, p[0] + placement.shift[0], p[1] + placement.shift[1], p[2] + placement.shift[2]);
    });
}

/// Rows of cells of all kinds: those of `offsets`, which are cell_offsets(), and one per prism.
inline std::size_t cell_rows(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets) {
  return offsets.size() - 1 + static_cast<std::size_t>(mesh.layers.cells());
}

/// Writes all points to `file`, which is as VtkOutput.
template <typename Output>
void write_all_points(Output& file, const ColumnMesh& mesh, const Placement& placement,
                      const Progress& progress) {
  file.write_next(
      point_rows(mesh),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_points(mesh, placement, begin, end, buffer);
      },
      progress);
}

/// Writes the regions of all cells and, if there are any, their zones.
template <typename Output>
void write_regions(Output& file, const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                   const CellZones& zones, const Progress& progress) {
  file.write_next(
      cell_rows(mesh, offsets),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_regions(mesh, offsets, begin, end, buffer);
      },
      progress);
  if (zones.empty()) return;
  file.write_next(zones.of_cell.size(),
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t c = begin; c < end; ++c) append_raw(buffer, zones.of_cell[c]);
                  });
}

/// The number of the first cell of a row of cell_rows(); of the row beyond all, of all cells.
inline std::size_t first_cell_of(const std::vector<CellIndex>& offsets, std::size_t row) {
  const std::size_t rows = offsets.size() - 1;
  return row <= rows ? std::size_t{offsets[row]} : std::size_t{offsets[rows]} + (row - rows);
}

/// Calls visit(nodes) for the cells of a row of cell_rows(): arrays of 4, or of 6 as wedge() has
/// them.
template <typename Visit>
void for_each_cell_of(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                      std::size_t row, const Visit& visit) {
  const std::size_t rows = offsets.size() - 1;
  if (row < rows)
    for_each_tet_of(mesh, row, visit);
  else
    visit(wedge(mesh, static_cast<std::int64_t>(row - rows)));
}

/// Tets and prisms.
struct CellCounts {
  std::size_t tets, prisms;
  std::size_t all() const { return tets + prisms; }
  std::size_t corners() const { return 4 * tets + 6 * prisms; }
};
inline CellCounts count_cells(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets) {
  return {std::size_t{offsets.back()}, static_cast<std::size_t>(mesh.layers.cells())};
}

/// The faces of a patch: triangles, and then quadrilaterals.
struct PatchFaces {
  Patch patch;
  std::size_t begin;      ///< In SurfaceMesh::triangles.
  std::size_t triangles;  ///< Faces of three corners,
  std::size_t quads;      ///< and of four.
  std::size_t first;      ///< How many faces come before those of this patch.
  std::size_t faces() const { return triangles + quads; }
};

/// Of the patches with faces, in their order. Throws Error(kUsage) where quadrilaterals are not the
/// last of their patch.
std::vector<PatchFaces> faces_of_patches(const SurfaceMesh& surface);

/// Calls visit(nodes) for the faces [begin, end) of those of a patch: arrays of 3 or 4.
template <typename Visit>
void for_each_face_of(const SurfaceMesh& surface, const PatchFaces& range, std::size_t begin,
                      std::size_t end, const Visit& visit) {
  const auto node = [&](std::size_t t, std::size_t corner) {
    return surface.node[static_cast<std::size_t>(surface.triangles[t][corner])];
  };
  for (std::size_t f = begin; f < end; ++f) {
    const std::size_t quad = f - std::min(f, range.triangles);
    const std::size_t t = range.begin + f + quad;
    if (f < range.triangles)
      visit(std::array{node(t, 0), node(t, 1), node(t, 2)});
    else
      visit(std::array{node(t, 0), node(t, 1), node(t, 2), node(t + 1, 2)});
  }
}

/// The cell behind face f of those of a patch.
inline CellIndex cell_behind(const SurfaceMesh& surface, const PatchFaces& range, std::size_t f) {
  return surface.cell[range.begin + f + (f - std::min(f, range.triangles))];
}

/// How many faces a surface has: quadrilaterals are one each.
inline std::size_t count_faces(const SurfaceMesh& surface) {
  return surface.triangles.size() - surface.quads.size();
}

/// Throws Error(kGuarantee) unless `surface` has node and cell numbers of `mesh`, and at each point
/// of the surface is the node it names. Error(kUsage) unless patches ascend.
void require_boundary_of(const ColumnMesh& mesh, const SurfaceMesh& surface);

}  // namespace tetropolis
