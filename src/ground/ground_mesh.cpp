#include "tetropolis/ground/ground_mesh.h"

#include <utility>

#include "core/sort_once.h"

namespace tetropolis {

VertexRegions regions_at_vertices(const GroundMesh& mesh) {
  const std::size_t vertices = mesh.vertices.size();
  std::vector<RegionIndex> one(vertices, kNoRegion);
  std::vector<std::pair<VertexIndex, RegionIndex>> others;  // few vertices have more
  for (const TriangleIndex t : mesh.triangles.indices())
    for (const VertexIndex v : mesh.triangles[t]) {
      RegionIndex& own = one[v];
      if (own == kNoRegion) own = mesh.region[t];
      if (own != mesh.region[t]) others.emplace_back(v, mesh.region[t]);
    }
  for (const auto& [v, region] : std::vector(others)) others.emplace_back(v, one[v]);
  sort_once(others);
  VertexRegions result;
  result.offsets.reserve(vertices + 1);
  result.values.reserve(vertices + others.size());
  auto other = others.begin();
  for (const VertexIndex v : mesh.vertices.indices()) {
    if (other == others.end() || other->first != v) {
      if (one[v] != kNoRegion) result.values.push_back(one[v]);
    } else {
      for (; other != others.end() && other->first == v; ++other)
        result.values.push_back(other->second);
    }
    result.offsets.push_back(static_cast<std::int32_t>(result.values.size()));
  }
  return result;
}

}  // namespace tetropolis
