#include "tetropolis/ground/ground_mesh.h"

#include <utility>

#include "core/sort_once.h"

namespace tetropolis {

VertexRegions regions_at_vertices(const GroundMesh& mesh) {
  const std::size_t vertices = mesh.vertices.size();
  std::vector<RegionIndex> one(vertices, kNoRegion);
  std::vector<std::pair<VertexIndex, RegionIndex>> others;  // few vertices have more
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const VertexIndex v : mesh.triangles[t]) {
      RegionIndex& own = one[static_cast<std::size_t>(v)];
      if (own == kNoRegion) own = mesh.region[t];
      if (own != mesh.region[t]) others.emplace_back(v, mesh.region[t]);
    }
  for (const auto& [v, region] : std::vector(others))
    others.emplace_back(v, one[static_cast<std::size_t>(v)]);
  sort_once(others);
  VertexRegions result;
  result.first.reserve(vertices + 1);
  result.regions.reserve(vertices + others.size());
  result.first.push_back(0);
  auto other = others.begin();
  for (std::size_t v = 0; v < vertices; ++v) {
    if (other == others.end() || other->first != static_cast<VertexIndex>(v)) {
      if (one[v] != kNoRegion) result.regions.push_back(one[v]);
    } else {
      for (; other != others.end() && other->first == static_cast<VertexIndex>(v); ++other)
        result.regions.push_back(other->second);
    }
    result.first.push_back(static_cast<std::int32_t>(result.regions.size()));
  }
  return result;
}

}  // namespace tetropolis
