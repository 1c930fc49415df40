#include "layered_mesh.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "tetropolis/core/error.h"

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerCount = 4096;

}  // namespace

LayeredMesh make_layers(GroundMesh ground, std::int32_t layers, double bottom, double top) {
  if (layers < 1 || !(bottom < top))
    throw Error(ErrorKind::kGuarantee,
                "the domain has no height: raise the domain height or lower the layer height");
  std::vector<double> z;
  for (std::int32_t k = 0; k <= layers; ++k)
    z.push_back(k == layers ? top : bottom + (top - bottom) * k / layers);
  LayeredMesh mesh = make_layers(std::move(ground), std::move(z));
  mesh.ladder.clear();
  return mesh;
}

LayeredMesh make_layers(GroundMesh ground, std::vector<double> ladder) {
  LayeredMesh mesh;
  mesh.edges = build_edge_graph(ground);
  mesh.ground = std::move(ground);
  mesh.layers = static_cast<std::int32_t>(ladder.size()) - 1;
  mesh.first_layer.assign(mesh.triangle_count(), 0);
  mesh.first_node.assign(mesh.vertex_count(), 0);
  mesh.roof_layer.assign(mesh.vertex_count(), kNoRoof);
  mesh.z.resize(mesh.vertex_count() * mesh.stride());
  parallel_chunks(mesh.vertex_count(), 1024, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end))
      std::copy(ladder.begin(), ladder.end(), mesh.column(v));
  });
  mesh.ladder = std::move(ladder);
  return mesh;
}

ColumnMesh columns_of_layers(LayeredMesh&& layered) {
  ColumnMesh mesh;
  const std::size_t vertices = layered.vertex_count();
  mesh.first.resize(vertices + 1);
  mesh.regions = regions_at_vertices(layered.ground);
  for (const VertexIndex v : indices<VertexIndex>(vertices)) {
    mesh.first[v + 1] = mesh.first[v] + layered.layers + 1 - layered.first_node[v];
    for (const RegionIndex region : mesh.regions[v])
      mesh.floors.push_back(layered.ground.regions[region].is_building()
                                ? layered.roof_layer[v] - layered.first_node[v]
                                : 0);
  }
  mesh.z.resize(static_cast<std::size_t>(mesh.node_count()));
  parallel_chunks(vertices, kColumnsPerCount, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end))
      std::copy(layered.column(v) + layered.first_node[v], layered.column(v) + layered.layers + 1,
                mesh.z.data() + mesh.first[v]);
  });
  mesh.ground = std::move(layered.ground);
  mesh.edges = std::move(layered.edges);
  layered = {};
  return mesh;
}

}  // namespace tetropolis
