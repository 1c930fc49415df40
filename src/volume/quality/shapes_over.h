// The shapes of the tets over a triangle of the ground mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "tetropolis/volume/column/column_mesh.h"

#include "tet_cosines.h"

namespace tetropolis {

/// for_each_tet_over() with positions and shapes: calls visit(nodes, positions, shape).
template <typename Visit>
void for_each_shape_over(const ColumnMesh& mesh, std::size_t t, const Visit& visit) {
  const auto& v = mesh.ground.triangles[t];
  const Climb<3> start = climb_triangle(mesh, t);
  std::array<Point3, 4> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = position(mesh, v[i], start.at(i));
  for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& nodes) {
    for (std::size_t i = 0; i < 3; ++i) p[i][2] = mesh.z[static_cast<std::size_t>(nodes[i])];
    const auto below = static_cast<std::size_t>(
        std::find(nodes.begin(), nodes.end(), nodes[3] - 1) - nodes.begin());
    p[3] = {p[below][0], p[below][1], mesh.z[static_cast<std::size_t>(nodes[3])]};
    visit(nodes, p, tet_cosines(p[0], p[1], p[2], p[3]));
  });
}

}  // namespace tetropolis
