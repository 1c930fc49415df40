#include "prism_faces.h"

#include <algorithm>

namespace tetropolis {

std::vector<CellFace> prism_faces(const ColumnMesh& mesh, CellIndex first_prism) {
  std::vector<CellFace> faces;
  struct Side {
    TriangleIndex beyond;
    VertexIndex from, to;  // with the triangle on their left
    std::int32_t above;    // of its stack, that of the triangle begins there
  };
  std::vector<Side> sides;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const std::int32_t count = prism_count(mesh, t);
    if (count == 0) continue;
    const auto& v = mesh.ground.triangles[t];
    sides.clear();
    for (const EdgeIndex e : mesh.edges.of_triangle[t]) {
      const auto& pair = mesh.edges.triangles[e];
      const TriangleIndex other = pair[0] == t ? pair[1] : pair[0];
      if (other == kNoTriangle || other < t || prism_count(mesh, other) == 0) continue;
      const auto& ends = mesh.edges.vertices[e];
      const auto at = std::find(v.begin(), v.end(), ends[0]) - v.begin();
      const bool forward = v[static_cast<std::size_t>((at + 1) % 3)] == ends[1];
      sides.push_back({other, ends[forward ? 0 : 1], ends[forward ? 1 : 0],
                       prisms_above(mesh, t, other, ends[0])});
    }
    std::sort(sides.begin(), sides.end(),
              [](const Side& a, const Side& b) { return a.beyond < b.beyond; });
    for (std::int32_t k = 0; k < count; ++k) {
      const CellIndex own = first_prism + (mesh.layers.offsets[t] + k);
      const auto node = [&](VertexIndex u, std::int32_t above) {
        return prism_node(mesh, t, u, k + above);
      };
      if (k + 1 < count)
        faces.push_back({own, own + 1, {node(v[0], 1), node(v[1], 1), node(v[2], 1), {}}, 3});
      for (const auto& [beyond, from, to, above] : sides)
        if (k + above >= 0)
          faces.push_back({own,
                           first_prism + (mesh.layers.offsets[beyond] + k + above),
                           {node(from, 0), node(to, 0), node(to, 1), node(from, 1)},
                           4});
    }
  }
  return faces;
}

}  // namespace tetropolis
