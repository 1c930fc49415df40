#include "tetropolis/volume/column_mesh.h"

#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"

namespace tetropolis {

ColumnMesh make_columns(GroundMesh ground, std::int32_t layers, double bottom, double top) {
  if (layers < 1 || !(bottom < top))
    throw Error(ErrorKind::kGuarantee,
                "the domain has no height: raise the domain height or lower the layer height");
  ColumnMesh mesh;
  mesh.edges = build_edge_graph(ground);
  mesh.ground = std::move(ground);
  mesh.layers = layers;
  mesh.first_layer.assign(mesh.triangle_count(), 0);
  mesh.first_node.assign(mesh.vertex_count(), 0);
  mesh.roof_layer.assign(mesh.vertex_count(), kNoRoof);
  mesh.z.resize(mesh.vertex_count() * mesh.stride());
  parallel_chunks(mesh.vertex_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      for (std::int32_t k = 0; k <= layers; ++k)
        mesh.column(v)[k] = k == layers ? top : bottom + (top - bottom) * k / layers;
  });
  return mesh;
}

std::vector<NodeIndex> node_offsets(const ColumnMesh& mesh) {
  std::vector<NodeIndex> offsets(mesh.vertex_count() + 1, 0);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    offsets[v + 1] = offsets[v] + mesh.layers + 1 - mesh.first_node[v];
  return offsets;
}

NodeIndex cell_count(const ColumnMesh& mesh) {
  NodeIndex prisms = 0;
  for (const std::int32_t first : mesh.first_layer) prisms += mesh.layers - first;
  return 3 * prisms;
}

std::array<std::array<Node, 4>, 3> prism_tets(const ColumnMesh& mesh, TriangleIndex t,
                                              std::int32_t k) {
  const auto& triangle = mesh.ground.triangles[static_cast<std::size_t>(t)];
  const auto v = sorted_vertices(triangle);
  const Node u1{v[0], k}, u2{v[1], k}, u3{v[2], k};
  const Node w1{v[0], k + 1}, w2{v[1], k + 1}, w3{v[2], k + 1};
  // Sorting keeps the triangle counter-clockwise when it is a rotation of its stored order.
  const bool ccw = (v[0] == triangle[0] && v[1] == triangle[1]) ||
                   (v[0] == triangle[1] && v[1] == triangle[2]) ||
                   (v[0] == triangle[2] && v[1] == triangle[0]);
  // The first three nodes project onto the triangle; the fourth is the upper end of the vertical
  // edge.
  if (ccw) return {{{u1, u2, u3, w3}, {u1, u2, w3, w2}, {u1, w2, w3, w1}}};
  return {{{u1, u3, u2, w3}, {u1, w3, u2, w2}, {u1, w3, w2, w1}}};
}

}  // namespace tetropolis
