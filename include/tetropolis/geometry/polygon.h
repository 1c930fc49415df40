// Elementary facts about rings and polygons.
#pragma once

#include <span>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Positive for counter-clockwise rings. Square metres. Rings of fewer than three vertices have 0.
double signed_area(const Ring& ring);

/// Area of the outer ring less its holes, whatever their orientation.
double area(const Polygon& polygon);

/// Bounding box of the vertices; empty for an empty ring.
Bounds2 bounds(const Ring& ring);
Bounds2 bounds(const Polygon& polygon);

/// Even-odd rule over all rings. Points exactly on an edge may go either way, but consistently: of
/// two polygons that share an edge exactly one contains such a point.
bool contains(const Polygon& polygon, Point2 p);

/// Distance from `p` to the segment a-b (which may be a single point). Metres.
double distance_to_segment(Point2 p, Point2 a, Point2 b);

/// Distance from `p` to the nearest edge of any ring. Infinity for a polygon without vertices.
double distance_to_boundary(const Polygon& polygon, Point2 p);

/// Calls visit(a, b) for every edge of every ring, outer first.
template <typename Visit>
void for_each_edge(const Polygon& polygon, const Visit& visit) {
  const auto ring_edges = [&](const Ring& ring) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) visit(ring[j], ring[i]);
  };
  if (!polygon.outer.empty()) ring_edges(polygon.outer);
  for (const Ring& hole : polygon.holes)
    if (!hole.empty()) ring_edges(hole);
}

}  // namespace tetropolis
