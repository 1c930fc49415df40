#include "outline.h"

#include <algorithm>
#include <cstddef>

#include "tetropolis/geometry/polygon.h"

#include "grid_geometry.h"

namespace tetropolis {

namespace {

void add_ring(Outline& o, const Ring& ring, std::int32_t group, bool is_hole) {
  const auto base = static_cast<std::int32_t>(o.point.size());
  const auto n = static_cast<std::int32_t>(ring.size());
  const auto id = static_cast<std::int32_t>(o.first.size());
  o.first.push_back(base);
  o.size.push_back(n);
  o.group.push_back(group);
  o.is_hole.push_back(is_hole ? 1 : 0);
  for (std::int32_t i = 0; i < n; ++i) {
    o.point.push_back(ring[static_cast<std::size_t>(i)]);
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
  for (auto* array : {&o.next, &o.prev, &o.ring}) array->reserve(vertices);
  o.point.reserve(vertices);
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    const auto group = static_cast<std::int32_t>(k);
    add_ring(o, polygons[k]->outer, group, false);
    for (const Ring& hole : polygons[k]->holes) add_ring(o, hole, group, true);
  }
  o.changed.assign(polygons.size(), 0);
  Bounds2 box = Bounds2::nothing();
  for (const Point2 p : o.point) box.extend(p);
  o.grid = EdgeGrid(box, cell, vertices);
  for (std::int32_t v = 0; v < o.vertex_count(); ++v) o.grid.insert(v, o.at(v), o.at(o.after(v)));
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

Ring ring_through(const Outline& outline, std::int32_t v) {
  Ring ring;
  std::int32_t w = v;
  do {
    ring.push_back(outline.at(w));
    w = outline.after(w);
  } while (w != v);
  return ring;
}

Polygon extract_polygon(const Outline& o, std::int32_t first_ring, std::int32_t ring_count) {
  Polygon polygon;
  for (std::int32_t r = first_ring; r < first_ring + ring_count; ++r) {
    const std::int32_t start = o.first[static_cast<std::size_t>(r)];
    if (start < 0) continue;
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
