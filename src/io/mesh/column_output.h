// What the writers of volume formats share.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
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

/// Appends the building of each of these cells (or kNoBuilding) as raw 32-bit numbers.
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

/// The consecutive faces of a patch.
struct PatchFaces {
  Patch patch;
  std::size_t begin;
  std::size_t end;
};

/// Of the patches with faces, in their order.
std::vector<PatchFaces> faces_of_patches(const SurfaceMesh& surface);

/// Throws Error(kUsage) that names the file if the mesh has prisms.
void refuse_prisms(const std::filesystem::path& path, const ColumnMesh& mesh);

/// Throws Error(kGuarantee) unless `surface` has node and cell numbers of `mesh`, and at each point
/// of the surface is the node it names.
void require_boundary_of(const ColumnMesh& mesh, const SurfaceMesh& surface);

}  // namespace tetropolis
