// Column meshes with bad cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

#include "support/test_data.h"

namespace tetropolis::testing {

inline std::vector<double> column(const ColumnMesh& mesh, VertexIndex v) {
  return {mesh.z.data() + mesh.first[v], mesh.z.data() + mesh.first[v + 1]};
}

/// A mesh in which a share of the columns lost most of their nodes, and the others stand anywhere.
inline ColumnMesh spoilt(const ColumnMesh& mesh, double share) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> step(-0.9, 0.9);
  std::bernoulli_distribution chosen(share), lost(0.6);
  ColumnMesh result = mesh;
  result.z.clear();
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    result.first[v] = NodeIndex(result.z.size());
    const std::vector<double> z = column(mesh, v);
    const bool spoil = chosen(random);
    for (std::size_t n = 0; n < z.size(); ++n) {
      bool fixed = n == 0 || n + 1 == z.size();
      for (std::size_t i = 0; i < mesh.regions[v].size(); ++i) {
        if (mesh.floors_at(v)[i] != static_cast<std::int32_t>(n)) continue;
        fixed = true;
        result.floors_at(v)[i] =
            static_cast<std::int32_t>(result.z.size() - std::size_t{result.first[v]});
      }
      if (!spoil || fixed) {
        result.z.push_back(z[n]);
      } else if (!lost(random)) {
        const double shift = step(random);
        const double to = z[n] + shift * (shift > 0 ? z[n + 1] - z[n] : z[n] - z[n - 1]);
        if (to > result.z.back()) result.z.push_back(to);
      }
    }
  }
  result.first.back() = NodeIndex(result.z.size());
  require_valid(result);
  return result;
}

}  // namespace tetropolis::testing
