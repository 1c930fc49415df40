#include "split_prisms.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace tetropolis {

TetMesh split_prisms(TetMesh mesh) {
  const std::size_t tets = mesh.cells.size();
  std::vector<std::int32_t> regions;
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
    const auto& wedge = mesh.wedges[w];
    // Corners in the order of their numbers, so that two prisms divide a side between them alike.
    std::array<std::size_t, 3> c{0, 1, 2};
    std::sort(c.begin(), c.end(),
              [&](std::size_t i, std::size_t j) { return wedge[i] < wedge[j]; });
    const bool is_turned = (c[1] + 3 - c[0]) % 3 != 1;
    std::array<std::int64_t, 3> at{wedge[c[0]], wedge[c[1]], wedge[c[2]]};
    for (const std::size_t i : {2, 1, 0}) {  // a front that climbs, as over a triangle of columns
      const std::int64_t above = wedge[3 + c[i]];
      std::array<std::int64_t, 4> tet{at[0], at[1], at[2], above};
      if (is_turned) std::swap(tet[0], tet[1]);
      mesh.cells.push_back(tet);
      if (!mesh.region.empty()) regions.push_back(mesh.region[tets + w]);
      at[i] = above;
    }
  }
  if (!mesh.region.empty()) mesh.region.resize(tets);
  mesh.region.insert(mesh.region.end(), regions.begin(), regions.end());
  mesh.wedges.clear();
  return mesh;
}

}  // namespace tetropolis
