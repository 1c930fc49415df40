#include "outline.h"

#include <algorithm>
#include <cstddef>

#include "tetropolis/geometry/polygon.h"

#include "grid_geometry.h"

namespace tetropolis {

namespace {

void add_ring(Outline& o, const Ring& ring, OutlinePolygon polygon, bool is_hole) {
  const OutlineVertex base = o.point.next();
  const OutlineRing id = o.first.next();
  const std::size_t n = ring.size();
  o.first.push_back(base);
  o.size.push_back(static_cast<std::int32_t>(n));
  o.polygon.push_back(polygon);
  o.is_hole.push_back(is_hole ? 1 : 0);
  for (std::size_t i = 0; i < n; ++i) {
    o.point.push_back(ring[i]);
    o.next.push_back(base + (i + 1) % n);
    o.prev.push_back(base + (i + n - 1) % n);
    o.ring.push_back(id);
  }
}

}  // namespace

Outline make_outline(const std::vector<const Polygon*>& polygons, double cell) {
  Outline o;
  std::size_t vertices = 0;
  for (const Polygon* polygon : polygons) {
    vertices += polygon->outer.size();
    for (const Ring& hole : polygon->holes) vertices += hole.size();
  }
  o.point.reserve(vertices);
  o.next.reserve(vertices);
  o.prev.reserve(vertices);
  o.ring.reserve(vertices);
  for (const OutlinePolygon k : indices<OutlinePolygon>(polygons.size())) {
    add_ring(o, polygons[k]->outer, k, false);
    for (const Ring& hole : polygons[k]->holes) add_ring(o, hole, k, true);
  }
  o.changed.assign(polygons.size(), 0);
  Bounds2 box = Bounds2::nothing();
  for (const Point2 p : o.point) box.extend(p);
  o.grid = EdgeGrid(box, cell, vertices);
  for (const OutlineVertex v : o.vertices()) o.grid.insert(v, o.at(v), o.at(o.after(v)));
  return o;
}

Outline outline_for(const std::vector<const Polygon*>& polygons, double distance) {
  Bounds2 box = Bounds2::nothing();
  double length = 0;
  std::size_t edges = 0;
  for (const Polygon* polygon : polygons)
    for_each_edge(*polygon, [&](Point2 a, Point2 b) {
      box.extend(a);
      length += grid::distance(a, b);
      ++edges;
    });
  return make_outline(polygons, std::max(2 * distance, cell_size(box, length, edges)));
}

Ring ring_through(const Outline& outline, OutlineVertex v) {
  Ring ring;
  OutlineVertex w = v;
  do {
    ring.push_back(outline.at(w));
    w = outline.after(w);
  } while (w != v);
  return ring;
}

Polygon extract_polygon(const Outline& o, OutlineRing first_ring, std::size_t ring_count) {
  Polygon polygon;
  for (const OutlineRing r : indices(first_ring, first_ring + ring_count)) {
    const OutlineVertex start = o.first[r];
    if (!start.valid()) continue;
    Ring ring = ring_through(o, start);
    if (r == first_ring) {
      polygon.outer = std::move(ring);
    } else {
      polygon.holes.push_back(std::move(ring));
    }
  }
  return polygon;
}

}  // namespace tetropolis
