#include "column_output.h"

#include <algorithm>
#include <cstdint>

#include "tetropolis/core/error.h"

#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

[[noreturn]] void throw_not_sorted() {
  throw Error(
      ErrorKind::kUsage,
      "the faces of the boundary are not in the order of their patches; call sort_by_patch");
}

}  // namespace

std::vector<PatchFaces> faces_of_patches(const SurfaceMesh& surface) {
  std::vector<PatchFaces> ranges;
  std::size_t faces = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++faces) {
    if (ranges.empty() || ranges.back().patch != surface.patch[t])
      ranges.push_back({surface.patch[t], t, 0, 0, faces});
    PatchFaces& range = ranges.back();
    const bool is_quad = std::binary_search(surface.quads.begin(), surface.quads.end(),
                                            static_cast<std::int32_t>(t));
    if (!is_quad && range.quads > 0) throw_not_sorted();
    ++(is_quad ? range.quads : range.triangles);
    t += is_quad ? 2 : 1;
  }
  return ranges;
}

void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer) {
  const std::size_t layers = point_rows(mesh) - mesh.layers.vertices.size();
  const auto first_of = [&](std::size_t row) {
    const std::size_t column = std::min(row, mesh.vertex_count());
    const std::size_t upper = (row - column) * kUpperBlock;
    const std::size_t below = row - std::min(row, layers);
    return std::size_t{mesh.first[column]} + std::min(upper, mesh.upper.nodes()) +
           below * static_cast<std::size_t>(mesh.layers.count);
  };
  RawNumbers points(buffer, (first_of(end) - first_of(begin)) * 3 * sizeof(double));
  for (std::size_t row = begin; row < end; ++row)
    for_each_point_of(mesh, row, [&](NodeIndex, const Point3& p) {
      for (std::size_t c = 0; c < 3; ++c) points.put(p[c] + placement.shift[c]);
    });
}

void append_regions(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                    std::size_t begin, std::size_t end, std::string& buffer) {
  const std::size_t rows = offsets.size() - 1;
  const std::size_t cells = first_cell_of(offsets, end) - first_cell_of(offsets, begin);
  RawNumbers regions(buffer, cells * sizeof(std::int32_t));
  for (std::size_t row = begin; row < std::min(end, rows); ++row) {
    const BuildingIndex building = building_below(mesh, row);
    for (CellIndex c = offsets[row]; c < offsets[row + 1]; ++c) regions.put(building.value());
  }
  for (std::size_t row = std::max(begin, rows); row < end; ++row)
    regions.put(building_of_prism(mesh, static_cast<std::int64_t>(row - rows)).value());
}

void require_boundary_of(const ColumnMesh& mesh, const SurfaceMesh& surface) {
  const bool numbered = surface.node.size() == surface.points.size() &&
                        surface.cell.size() == surface.triangles.size();
  bool matches = numbered;
  for (std::size_t i = 0; matches && i < surface.node.size(); ++i) {
    const NodeIndex n = surface.node[i];
    matches = n >= 0 && n < mesh.node_count() && elevation(mesh, n) == surface.points[i][2];
  }
  if (!matches)
    throw Error(ErrorKind::kGuarantee, "the surface is not the boundary of the volume mesh");
  if (!std::is_sorted(surface.patch.begin(), surface.patch.end())) throw_not_sorted();
}

}  // namespace tetropolis
