#include "column_output.h"

#include "tetropolis/core/error.h"

#include "chunked_output.h"

namespace tetropolis {

void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer) {
  for (std::size_t v = begin; v < end; ++v)
    for (NodeIndex n = mesh.first[v]; n < mesh.first[v + 1]; ++n) {
      append_raw(buffer, mesh.ground.vertices[v].x + placement.shift[0]);
      append_raw(buffer, mesh.ground.vertices[v].y + placement.shift[1]);
      append_raw(buffer, mesh.z[static_cast<std::size_t>(n)] + placement.shift[2]);
    }
}

void require_boundary_of(const ColumnMesh& mesh, const SurfaceMesh& surface) {
  const bool numbered = surface.node.size() == surface.points.size() &&
                        surface.cell.size() == surface.triangles.size();
  bool matches = numbered;
  for (std::size_t i = 0; matches && i < surface.node.size(); ++i) {
    const NodeIndex n = surface.node[i];
    matches = n >= 0 && n < mesh.node_count() &&
              mesh.z[static_cast<std::size_t>(n)] == surface.points[i][2];
  }
  if (!matches)
    throw Error(ErrorKind::kGuarantee, "the surface is not the boundary of the volume mesh");
}

}  // namespace tetropolis
