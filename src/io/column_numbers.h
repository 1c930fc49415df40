// How volume files number the nodes and cells of a column mesh, and which cells share which faces:
// all by arithmetic, so writers stream.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/vtk.h"
#include "tetropolis/volume/boundary.h"
#include "tetropolis/volume/column_mesh.h"

namespace tetropolis {

inline constexpr NodeIndex kNoCell = -1;

/// The numbering of write_vtu: nodes column by column, cells triangle by triangle and upwards,
/// three a prism in the order of prism_tets. Refers to the mesh, which must outlive it.
struct ColumnNumbers {
  const ColumnMesh& mesh;
  std::vector<NodeIndex> nodes;  ///< node_offsets.
  std::vector<NodeIndex> cells;  ///< T + 1 offsets: the first cell over each triangle.

  NodeIndex node_count() const { return nodes.back(); }
  NodeIndex cell_count() const { return cells.back(); }
  NodeIndex node(const Node& n) const {
    const auto v = static_cast<std::size_t>(n.vertex);
    return nodes[v] + n.layer - mesh.first_node[v];
  }
  /// Tet i (0, 1 or 2) over triangle t between layers k and k + 1, which must exist.
  NodeIndex cell(std::size_t t, std::int32_t k, int i) const {
    return cells[t] + 3 * (k - mesh.first_layer[t]) + i;
  }
};
ColumnNumbers number_columns(const ColumnMesh& mesh);

/// Appends x, y, z of the nodes of the vertices [begin, end), shifted, as raw doubles.
void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer);

/// Calls visit(cell, nodes) for the tets over the triangles [begin, end) in their order; `nodes`
/// are the numbers of the four corners, oriented as prism_tets has them.
template <typename Visit>
void for_each_tet(const ColumnNumbers& numbers, std::size_t begin, std::size_t end,
                  const Visit& visit) {
  const ColumnMesh& mesh = numbers.mesh;
  for (std::size_t t = begin; t < end; ++t) {
    NodeIndex cell = numbers.cells[t];
    for (std::int32_t k = mesh.first_layer[t]; k < mesh.layers; ++k)
      for (const auto& tet : prism_tets(mesh, static_cast<TriangleIndex>(t), k))
        visit(cell++, std::array{numbers.node(tet[0]), numbers.node(tet[1]), numbers.node(tet[2]),
                                 numbers.node(tet[3])});
  }
}

/// A face between two cells: its normal (right-hand rule) leaves `owner` for `neighbour`, and
/// owner < neighbour.
struct InternalFace {
  NodeIndex owner;
  NodeIndex neighbour;
  std::array<NodeIndex, 3> nodes;
};

/// The at most three faces between tet i of prism (t, k) and cells with higher numbers, by
/// ascending neighbour; the rest of the array is unused. Going through all cells in their order
/// gives every internal face once, in upper-triangular order.
struct FacesAbove {
  std::array<InternalFace, 3> faces;
  std::size_t count = 0;
};
FacesAbove faces_above(const ColumnNumbers& numbers, std::size_t t, std::int32_t k, int i);

template <typename Visit>
void for_each_internal_face(const ColumnNumbers& numbers, std::size_t begin, std::size_t end,
                            const Visit& visit) {
  for (std::size_t t = begin; t < end; ++t)
    for (std::int32_t k = numbers.mesh.first_layer[t]; k < numbers.mesh.layers; ++k)
      for (int i = 0; i < 3; ++i) {
        const FacesAbove above = faces_above(numbers, t, k, i);
        for (std::size_t f = 0; f < above.count; ++f) visit(above.faces[f]);
      }
}

/// The node of the mesh at each point of its boundary. `surface` must be what extract_boundary made
/// of `mesh` or some of its patches; a point that is no node throws Error(kGuarantee) naming it.
std::vector<Node> boundary_nodes(const ColumnMesh& mesh, const SurfaceMesh& surface);

/// The one cell that the boundary face with these corners belongs to. Precondition: `face` is a
/// face of extract_boundary(mesh).
NodeIndex cell_behind(const ColumnNumbers& numbers, const std::array<Node, 3>& face);

/// A progress that maps [0, 1] to [begin, end] of `whole`, for operations of several parts. Keeps a
/// reference: `whole` must outlive it.
inline Progress portion(const Progress& whole, double begin, double end) {
  Progress part;
  part.cancelled = whole.cancelled;
  if (whole.report)
    part.report = [&whole, begin, end](double fraction) {
      whole.report(begin + (end - begin) * std::min(fraction, 1.0));
    };
  return part;
}

}  // namespace tetropolis
