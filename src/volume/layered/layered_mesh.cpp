#include "layered_mesh.h"

#include <utility>

#include "tetropolis/core/error.h"

#include "core/parallel.h"

namespace tetropolis {

LayeredMesh make_layers(GroundMesh ground, std::int32_t layers, double bottom, double top) {
  if (layers < 1 || !(bottom < top))
    throw Error(ErrorKind::kGuarantee,
                "the domain has no height: raise the domain height or lower the layer height");
  LayeredMesh mesh;
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

}  // namespace tetropolis
