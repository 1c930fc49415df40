// All rings of many polygons as linked lists over one grid of edges: the working form of
// simplification, in which vertices come and go.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "edge_grid.h"

namespace tetropolis {

/// Coordinates are steps (grid_geometry.h). Vertex i is the start of edge i, which ends at next[i].
/// The interior is on the left of every edge.
struct Outline {
  std::vector<Point2> point;
  std::vector<std::int32_t> next;  ///< -1 for vertices that are gone.
  std::vector<std::int32_t> prev;
  std::vector<std::int32_t> ring;   ///< Ring of each vertex.
  std::vector<std::int32_t> first;  ///< Per ring: one of its vertices; -1 for rings that are gone.
  std::vector<std::int32_t> size;   ///< Per ring: number of vertices.
  std::vector<std::int32_t> group;  ///< Per ring: which polygon it belongs to.
  std::vector<std::uint8_t> is_hole;  ///< Per ring.
  std::vector<std::uint8_t> changed;  ///< Per polygon: whether a vertex of it came, went or moved.
  EdgeGrid grid;
  std::uint64_t edits = 0;  ///< How often vertices came, went or moved.

  bool alive(std::int32_t v) const { return next[static_cast<std::size_t>(v)] >= 0; }
  const Point2& at(std::int32_t v) const { return point[static_cast<std::size_t>(v)]; }
  std::int32_t after(std::int32_t v) const { return next[static_cast<std::size_t>(v)]; }
  std::int32_t before(std::int32_t v) const { return prev[static_cast<std::size_t>(v)]; }
  std::int32_t ring_of(std::int32_t v) const { return ring[static_cast<std::size_t>(v)]; }
  std::int32_t group_of(std::int32_t v) const {
    return group[static_cast<std::size_t>(ring_of(v))];
  }
  std::int32_t vertex_count() const { return static_cast<std::int32_t>(point.size()); }
};

/// Polygon k of the outline is *polygons[k]. `cell` is the wished size of the grid's cells.
Outline make_outline(const std::vector<const Polygon*>& polygons, double cell);

/// The same with cells that suit searches for edges within `distance` of each other.
Outline outline_for(const std::vector<const Polygon*>& polygons, double distance);

/// The ring that the vertex v belongs to, from v on.
Ring ring_through(const Outline& outline, std::int32_t v);

/// The polygon whose rings have the numbers from `first_ring`, its outer one, on; unchanged rings
/// keep their first vertex, holes that are gone are left out. Precondition: the outer ring is
/// alive.
Polygon extract_polygon(const Outline& outline, std::int32_t first_ring, std::int32_t ring_count);

}  // namespace tetropolis
