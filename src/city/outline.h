// All rings of many polygons as linked lists over one grid of edges: the working form of
// simplification, in which vertices come and go.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/indexed_vector.h"
#include "tetropolis/geometry/types.h"

#include "edge_grid.h"

namespace tetropolis {

/// A vertex of an outline, and the edge that starts there.
using OutlineVertex = LineIndex;
using OutlineRing = Index<struct OutlineRingTag>;
using OutlinePolygon = Index<struct OutlinePolygonTag>;

inline constexpr auto kNoOutlineVertex = OutlineVertex::none();

/// Coordinates are steps (grid_geometry.h). Vertex i is the start of edge i, which ends at next[i].
/// The interior is on the left of every edge.
struct Outline {
  IndexedVector<OutlineVertex, Point2> point;
  IndexedVector<OutlineVertex, OutlineVertex> next;  ///< None for vertices that are gone.
  IndexedVector<OutlineVertex, OutlineVertex> prev;
  IndexedVector<OutlineVertex, OutlineRing> ring;
  IndexedVector<OutlineRing, OutlineVertex> first;  ///< One of its vertices; none: it is gone.
  IndexedVector<OutlineRing, std::int32_t> size;    ///< Number of vertices.
  IndexedVector<OutlineRing, OutlinePolygon> polygon;
  IndexedVector<OutlineRing, std::uint8_t> is_hole;
  /// Whether a vertex of it came, went or moved.
  IndexedVector<OutlinePolygon, std::uint8_t> changed;
  EdgeGrid grid;
  std::uint64_t edits = 0;  ///< How often vertices came, went or moved.

  bool alive(OutlineVertex v) const { return next[v].valid(); }
  const Point2& at(OutlineVertex v) const { return point[v]; }
  OutlineVertex after(OutlineVertex v) const { return next[v]; }
  OutlineVertex before(OutlineVertex v) const { return prev[v]; }
  OutlineRing ring_of(OutlineVertex v) const { return ring[v]; }
  OutlinePolygon polygon_of(OutlineVertex v) const { return polygon[ring[v]]; }
  /// Of all vertices there are now, gone or not.
  IndexRange<OutlineVertex> vertices() const { return point.indices(); }
};

/// Polygon k of the outline is *polygons[k]. `cell` is the wished size of the grid's cells.
Outline make_outline(const std::vector<const Polygon*>& polygons, double cell);

/// The same with cells that suit searches for edges within `distance` of each other.
Outline outline_for(const std::vector<const Polygon*>& polygons, double distance);

/// The ring that the vertex v belongs to, from v on.
Ring ring_through(const Outline& outline, OutlineVertex v);

/// The polygon whose rings have the numbers from `first_ring`, its outer one, on; unchanged rings
/// keep their first vertex, holes that are gone are left out. Precondition: the outer ring is
/// alive.
Polygon extract_polygon(const Outline& outline, OutlineRing first_ring, std::size_t ring_count);

}  // namespace tetropolis
