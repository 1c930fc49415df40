// A column mesh as explicit lists, made the plain way: what the streaming code is compared with.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/cell_quality.h"

#include "tet_shape.h"

namespace tetropolis::testing {

struct ExplicitMesh {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<std::int64_t, 4>> cells;
  std::vector<std::int32_t> region;
  std::vector<TriangleIndex> triangle;  ///< That each cell stands over.
};

/// Each triangle's segments are sorted by the level of their midpoint (ties: higher vertex first);
/// each makes one tet with the highest nodes so far of the other two columns.
inline ExplicitMesh explicit_mesh(const ColumnMesh& mesh,
                                  const std::array<double, 3>& shift = {0, 0, 0}) {
  ExplicitMesh result;
  for (const VertexIndex v : mesh.ground.vertices.indices())
    for (const NodeIndex n : mesh.nodes(v))
      result.points.push_back({mesh.ground.vertices[v].x + shift[0],
                               mesh.ground.vertices[v].y + shift[1], mesh.z[n] + shift[2]});
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    struct Segment {
      double midpoint;
      VertexIndex vertex;
      std::size_t corner;
      NodeIndex node;
    };
    std::vector<Segment> segments;
    std::array<std::int64_t, 4> cell{};
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = mesh.ground.triangles[t][i];
      const NodeIndex floor = mesh.floor_over(t, v);
      cell[i] = floor.value();
      for (const NodeIndex n : indices(floor, mesh.top(v)))
        segments.push_back({(mesh.climbing()[n] + mesh.climbing()[n + 1]) / 2, v, i, n});
    }
    std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) {
      return std::tuple(a.midpoint, b.vertex, a.node) < std::tuple(b.midpoint, a.vertex, b.node);
    });
    for (const Segment& segment : segments) {
      cell[3] = segment.node.value() + 1;
      result.cells.push_back(cell);
      result.region.push_back(mesh.ground.region_of(t).building.value());
      result.triangle.push_back(t);
      cell[segment.corner] = cell[3];
    }
  }
  const UpperMesh& upper = mesh.upper;
  for (std::size_t i = 0; i < upper.nodes(); ++i) {
    const Point2 p = mesh.ground.vertices[upper.vertex[i]];
    result.points.push_back({p.x + shift[0], p.y + shift[1], upper.z[i] + shift[2]});
  }
  upper.for_each_cell(0, upper.cells(), [&](const UpperMesh::Cell& c) {
    const auto node = [&](std::size_t i) { return upper_node(mesh, c[i]).value(); };
    result.cells.push_back({node(0), node(1), node(2), node(3)});
    result.region.push_back(kNoBuilding.value());
    result.triangle.push_back(kNoTriangle);
  });
  return result;
}

/// How many cells have a dihedral angle outside the bounds.
inline std::int64_t count_bad_cells(const ColumnMesh& mesh, const AngleBounds& bounds) {
  const ExplicitMesh lists = explicit_mesh(mesh);
  return std::count_if(lists.cells.begin(), lists.cells.end(), [&](const auto& cell) {
    const auto p = [&](std::size_t i) { return lists.points[static_cast<std::size_t>(cell[i])]; };
    const TetShape shape = tet_shape(p(0), p(1), p(2), p(3));
    return shape.min_dihedral_deg < bounds.least || shape.max_dihedral_deg > bounds.greatest;
  });
}

}  // namespace tetropolis::testing
