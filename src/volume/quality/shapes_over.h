// The shapes of the tets over a triangle of the ground mesh.
#pragma once

#include <array>
#include <cstddef>

#include "tetropolis/volume/column/column_mesh.h"

#include "tet_cosines.h"

namespace tetropolis {

/// for_each_tet_over() with positions and shapes: calls visit(nodes, positions, shape).
template <typename Visit>
void for_each_shape_over(const ColumnMesh& mesh, TriangleIndex t, const Visit& visit) {
  const auto& v = mesh.ground.triangles[t];
  Climb<3> front = climb_triangle(mesh, t);
  std::array<Point3, 4> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = position(mesh, v[i], front.at(i));
  for (std::size_t i; (i = front.next()) < 3; front.advance(i)) {
    const auto& at = front.at();
    p[3] = position(mesh, v[i], at[i] + 1);
    visit(std::array{at[0], at[1], at[2], at[i] + 1}, p, tet_cosines(p[0], p[1], p[2], p[3]));
    p[i] = p[3];
  }
}

}  // namespace tetropolis
