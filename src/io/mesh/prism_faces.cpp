#include "prism_faces.h"

#include <algorithm>

namespace tetropolis {

CellIndex lowest_prism(const ColumnMesh& mesh, CellIndex first_prism, TriangleIndex t) {
  const auto& triangles = mesh.layers.triangles;
  const auto at = std::lower_bound(triangles.begin(), triangles.end(), t);
  return first_prism + (at - triangles.begin()) * std::int64_t{mesh.layers.count};
}

std::vector<PrismFace> prism_faces(const ColumnMesh& mesh, CellIndex first_prism) {
  const PrismLayers& layers = mesh.layers;
  std::vector<PrismFace> faces;
  struct Side {
    CellIndex beyond;
    VertexIndex from, to;  // with the triangle on their left
  };
  std::vector<Side> sides;
  for (std::size_t i = 0; i < layers.triangles.size(); ++i) {
    const TriangleIndex t = layers.triangles[i];
    const auto& v = mesh.ground.triangles[t];
    sides.clear();
    for (const EdgeIndex e : mesh.edges.of_triangle[t]) {
      const auto& pair = mesh.edges.triangles[e];
      const TriangleIndex other = pair[0] == t ? pair[1] : pair[0];
      if (other == kNoTriangle || other < t || !mesh.has_layers(other)) continue;
      const auto& ends = mesh.edges.vertices[e];
      const auto at = std::find(v.begin(), v.end(), ends[0]) - v.begin();
      const bool forward = v[static_cast<std::size_t>((at + 1) % 3)] == ends[1];
      sides.push_back(
          {lowest_prism(mesh, first_prism, other), ends[forward ? 0 : 1], ends[forward ? 1 : 0]});
    }
    std::sort(sides.begin(), sides.end(),
              [](const Side& a, const Side& b) { return a.beyond < b.beyond; });
    const CellIndex lowest = first_prism + static_cast<std::int64_t>(i) * layers.count;
    for (std::int32_t k = 0; k < layers.count; ++k) {
      const CellIndex own = lowest + std::int64_t{k};
      const auto node = [&](VertexIndex u, std::int32_t above) {
        return layer_node(mesh, u, k + above);
      };
      if (k + 1 < layers.count)
        faces.push_back({own, own + 1, {node(v[0], 1), node(v[1], 1), node(v[2], 1), {}}, 3});
      for (const auto& [beyond, from, to] : sides)
        faces.push_back({own,
                         beyond + std::int64_t{k},
                         {node(from, 0), node(to, 0), node(to, 1), node(from, 1)},
                         4});
    }
  }
  return faces;
}

}  // namespace tetropolis
