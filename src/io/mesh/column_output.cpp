#include "column_output.h"

#include "tetropolis/core/error.h"

#include "io/file/chunked_output.h"

namespace tetropolis {

std::vector<PatchFaces> faces_of_patches(const SurfaceMesh& surface) {
  std::vector<PatchFaces> ranges;
  for (std::size_t f = 0; f < surface.patch.size(); ++f) {
    if (ranges.empty() || ranges.back().patch != surface.patch[f])
      ranges.push_back({surface.patch[f], f, f});
    ranges.back().end = f + 1;
  }
  return ranges;
}

void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer) {
  const auto nodes = static_cast<std::size_t>(mesh.first[end] - mesh.first[begin]);
  RawNumbers points(buffer, nodes * 3 * sizeof(double));
  for (const VertexIndex v : indices<VertexIndex>(begin, end))
    for (const NodeIndex n : mesh.nodes(v)) {
      points.put(mesh.ground.vertices[v].x + placement.shift[0]);
      points.put(mesh.ground.vertices[v].y + placement.shift[1]);
      points.put(mesh.z[n] + placement.shift[2]);
    }
}

void append_regions(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                    std::size_t begin, std::size_t end, std::string& buffer) {
  const auto cells = static_cast<std::size_t>(offsets[end] - offsets[begin]);
  RawNumbers regions(buffer, cells * sizeof(std::int32_t));
  for (const TriangleIndex t : indices<TriangleIndex>(begin, end)) {
    const BuildingIndex building = mesh.ground.region_of(t).building;
    for (CellIndex c = offsets[t]; c < offsets[t + 1]; ++c) regions.put(building.value());
  }
}

void require_boundary_of(const ColumnMesh& mesh, const SurfaceMesh& surface) {
  const bool numbered = surface.node.size() == surface.points.size() &&
                        surface.cell.size() == surface.triangles.size();
  bool matches = numbered;
  for (std::size_t i = 0; matches && i < surface.node.size(); ++i) {
    const NodeIndex n = surface.node[i];
    matches = n >= 0 && n < mesh.node_count() && mesh.z[n] == surface.points[i][2];
  }
  if (!matches)
    throw Error(ErrorKind::kGuarantee, "the surface is not the boundary of the volume mesh");
}

}  // namespace tetropolis
