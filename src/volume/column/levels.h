// Levels: what fronts go by where roofs are not horizontal (column_mesh.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

#include "roof_heights.h"

namespace tetropolis {

/// A column's levels and the floors in it.
struct LevelledColumn {
  VertexIndex vertex;
  std::span<const double> level;         ///< Per node, upwards.
  std::span<const std::int32_t> floors;  ///< Positions, in the order of the regions around.
};

/// Writes the level of every node of a column over v: piecewise linear in elevation between the
/// floors, which have `floor_levels` (in the order of the regions around v), and the top, where
/// level and elevation are the same. Exactly the elevation where both ends of a piece have levels
/// that are their elevations. Precondition: floor levels increase with elevation.
void write_levels(std::span<const double> z, std::span<const std::int32_t> floors,
                  std::span<const double> floor_levels, double* level);

/// The columns at the ends of an edge, as they look from the two regions on its sides.
struct StepEnds {
  std::array<VertexIndex, 2> vertex;
  std::array<const double*, 2> level;     ///< Per node, from the column's lowest.
  std::array<std::int32_t, 2> low, high;  ///< Positions of the lower and of the upper floor.
  std::array<std::int32_t, 2> last;       ///< And of the top.
};

/// Whether a front that climbs from the lower floor passes through the edge between the upper
/// floors: all segments below it go before all segments above it.
bool passes(const StepEnds& ends);

/// Whether fronts pass through the upper floor's edge over edge e.
bool passes(const ColumnMesh& mesh, EdgeIndex e);

/// Over all edges.
bool passes_everywhere(const ColumnMesh& mesh);

/// The buildings of roofs whose edges fronts miss, ascending.
std::vector<BuildingIndex> missed_buildings(const ColumnMesh& mesh);

/// The same over all edges around vertex v with `own` as its column and column(u) as those of
/// others.
template <typename ColumnAt>
bool passes_around(const ColumnMesh& mesh, const LevelledColumn& own, const ColumnAt& column);

/// Finds levels of roofs for which fronts pass through all their edges, changing as few from
/// elevations, and as little, as may be; sets `level` in `roofs`, and floor_levels and levels in
/// `mesh`. At edges where no levels were found the step is closed: the lower roof is lifted to the
/// upper one in `roofs` at both ends. The result is how many were; if any, columns have to be
/// divided anew. What happens at an edge depends on connected edges of roofs only. Precondition:
/// `roofs` are not all flat, and are those of `mesh`, which has nodes.
std::int64_t find_levels(ColumnMesh& mesh, RoofHeights& roofs);

/// Gives a mesh that was divided anew the levels that roofs have.
void set_levels(ColumnMesh& mesh, const RoofHeights& roofs);

// Implementation.

/// Over edge e between v[0] and v[1], with columns c.
inline StepEnds step_ends(const ColumnMesh& mesh, EdgeIndex e,
                          const std::array<LevelledColumn, 2>& c) {
  const std::array<TriangleIndex, 2>& sides = mesh.edges.triangles[e];
  StepEnds ends{};
  for (std::size_t i = 0; i < 2; ++i) {
    const VertexIndex v = c[i].vertex;
    const auto floor = [&](std::size_t s) {
      return c[i].floors[mesh.place(mesh.ground.region[sides[s]], v)];
    };
    ends.vertex[i] = v;
    ends.level[i] = c[i].level.data();
    ends.low[i] = std::min(floor(0), floor(1));
    ends.high[i] = std::max(floor(0), floor(1));
    ends.last[i] = static_cast<std::int32_t>(c[i].level.size()) - 1;
  }
  return ends;
}

/// Whether floors differ over edge e.
inline bool is_step(const ColumnMesh& mesh, EdgeIndex e) {
  const auto [t0, t1] = mesh.edges.triangles[e];
  return t1 != kNoTriangle && mesh.ground.region[t0] != mesh.ground.region[t1];
}

template <typename ColumnAt>
bool passes_around(const ColumnMesh& mesh, const LevelledColumn& own, const ColumnAt& column) {
  const auto passes_over = [&](EdgeIndex e, VertexIndex other) {
    return !is_step(mesh, e) || passes(step_ends(mesh, e, {own, column(other)}));
  };
  for (const EdgeIndex e : mesh.edges.starting_at(own.vertex))
    if (!passes_over(e, mesh.edges.vertices[e][1])) return false;
  for (const EdgeIndex e : mesh.edges.ends[own.vertex])
    if (!passes_over(e, mesh.edges.vertices[e][0])) return false;
  return true;
}

}  // namespace tetropolis
