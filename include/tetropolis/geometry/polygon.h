// Elementary facts about rings and polygons.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Positive for counter-clockwise rings. Square metres. Rings of fewer than three vertices have 0.
double signed_area(const Ring& ring);

/// Area of the outer ring less its holes, whatever their orientation.
double area(const Polygon& polygon);

/// The sum of their areas; what several cover counts for each.
double total_area(std::span<const Polygon> polygons);

/// Bounding box of the points of a ring, or of any others; Bounds2::nothing() without any.
Bounds2 bounds(std::span<const Point2> points);
Bounds2 bounds(const Polygon& polygon);

/// The box as a polygon, counter-clockwise. Precondition: not empty.
Polygon rectangle(const Bounds2& box);

/// Pointers to all of them, in order.
std::vector<const Polygon*> pointers_to(std::span<const Polygon> polygons);

/// The first of those of greatest area(). Precondition: at least one.
const Polygon& largest(std::span<const Polygon> polygons);

/// Whether the ray from `p` towards +x crosses the edge a-b. The end points count as if they lay a
/// little lower, and `p` exactly on the edge does not cross. The same answer for b-a.
inline bool crosses_ray(Point2 a, Point2 b, Point2 p) {
  if ((a.y > p.y) == (b.y > p.y)) return false;
  // Evaluated from the lower to the upper end, whichever way the ring runs: two polygons that share
  // an edge take the same decision.
  if (a.y > b.y) std::swap(a, b);
  return (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y) > 0;
}

/// Even-odd rule over all rings: an odd number of crosses_ray. Points exactly on an edge may go
/// either way, but consistently: of two polygons that share an edge exactly one contains such a
/// point.
bool contains(const Polygon& polygon, Point2 p);

/// The point of the segment a-b (which may be a single point) that is nearest to `p`; exactly an
/// end where that is an end. Only additions, multiplications and a division: the same bits on every
/// platform.
inline Point2 nearest_on_segment(Point2 p, Point2 a, Point2 b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  if (!(length2 > 0)) return a;
  const double t = ((p.x - a.x) * dx + (p.y - a.y) * dy) / length2;
  if (t <= 0) return a;
  if (t >= 1) return b;
  return {a.x + t * dx, a.y + t * dy};
}

/// Square of the distance from `p` to the segment a-b (which may be a single point), to the
/// point above. Square metres.
inline double squared_distance_to_segment(Point2 p, Point2 a, Point2 b) {
  const Point2 q = nearest_on_segment(p, a, b);
  const double dx = p.x - q.x, dy = p.y - q.y;
  return dx * dx + dy * dy;
}

/// Distance from `p` to the segment a-b (which may be a single point). Metres.
double distance_to_segment(Point2 p, Point2 a, Point2 b);

/// Distance from `p` to the nearest edge of any ring. Infinity for a polygon without vertices.
double distance_to_boundary(const Polygon& polygon, Point2 p);

/// A point strictly inside: the middle of the widest interior run of a horizontal line that passes
/// between two neighbouring vertex ordinates next to the middle of the bounding box, so through no
/// vertex. Where that run is too thin for doubles the other ordinates are tried, widest run first.
/// A polygon without interior gives the middle of its bounding box. Any orientation of the rings.
/// Precondition: at least one vertex; rings do not cross.
Point2 interior_point(const Polygon& polygon);

/// Calls visit(vertex), which may move it, for every vertex of every ring, outer first.
template <typename Visit>
void for_each_vertex(Polygon& polygon, const Visit& visit) {
  for (Point2& p : polygon.outer) visit(p);
  for (Ring& hole : polygon.holes)
    for (Point2& p : hole) visit(p);
}

/// Calls visit(ring) for every ring, outer first.
template <typename AnyPolygon, typename Visit>
void for_each_ring(AnyPolygon& polygon, const Visit& visit) {
  visit(polygon.outer);
  for (auto& hole : polygon.holes) visit(hole);
}

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
