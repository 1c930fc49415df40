// The places of a mesh that have faults, each with the part of the mesh around it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

#include "volume/column/fill_columns.h"

namespace tetropolis {

/// Places around the `seeds` (per vertex, 1: a fault is there), as ascending lists of vertices: no
/// vertex is in two of them. A place has the vertices that are up to sixteen edges from its seeds,
/// and nearer to them than to those of others; whole buildings count as one vertex. Seeds with
/// eight edges between them, or fewer, belong to the same place. So a place depends on seeds within
/// 32 edges of its own and on nothing else, numbering aside.
std::vector<std::vector<VertexIndex>> find_places(const Columns& columns,
                                                  std::span<const std::uint8_t> seeds);

/// A part of a mesh: the triangles between some of its vertices. These keep their order; regions
/// keep their numbers.
struct Cutout {
  Columns columns;
  std::vector<std::uint8_t> fixed;  ///< Per vertex, 1: on the rim or next to it. What the others
                                    ///< change, cells and faces outside the cutout do not notice.
};

/// `vertices` ascend.
Cutout cut_out(const Columns& columns, std::span<const VertexIndex> vertices);

/// A column of a mesh.
struct ColumnOf {
  const ColumnMesh* mesh;
  VertexIndex vertex;
};

/// The columns that of(v) names for v = 0 .. vertices - 1: a mesh without ground mesh and edges.
template <typename Of>
ColumnMesh gather_columns(std::size_t vertices, const Of& of) {
  ColumnMesh mesh;
  mesh.first.push_back({});
  bool has_levels = false;
  for (const VertexIndex v : indices<VertexIndex>(vertices))
    has_levels |= !of(v).mesh->levels.empty();
  for (const VertexIndex v : indices<VertexIndex>(vertices)) {
    const ColumnOf own = of(v);
    const auto& first = own.mesh->first;
    mesh.z.insert(mesh.z.end(), own.mesh->z.data() + first[own.vertex],
                  own.mesh->z.data() + first[own.vertex + 1]);
    mesh.regions.push_back(own.mesh->regions[own.vertex]);
    const auto floors = own.mesh->floors_at(own.vertex);
    mesh.floors.insert(mesh.floors.end(), floors.begin(), floors.end());
    if (has_levels) {
      const double* const level = own.mesh->climbing().data();
      mesh.levels.insert(mesh.levels.end(), level + first[own.vertex],
                         level + first[own.vertex + 1]);
      for (const std::int32_t floor : floors)
        mesh.floor_levels.push_back(*(level + (first[own.vertex] + floor)));
    }
    mesh.first.push_back(NodeIndex(mesh.z.size()));
  }
  return mesh;
}

/// The columns that are not alike in two meshes over the same ground mesh, which they may lack.
std::vector<VertexIndex> different_columns(const ColumnMesh& a, const ColumnMesh& b);

}  // namespace tetropolis
