#include "part_tiling.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "geometry/geos.h"

namespace tetropolis {

namespace {

struct Edge {
  Point2 a, b;
  friend bool operator==(const Edge&, const Edge&) = default;
  friend bool operator<(const Edge& s, const Edge& t) {
    return std::tie(s.a.x, s.a.y, s.b.x, s.b.y) < std::tie(t.a.x, t.a.y, t.b.x, t.b.y);
  }
};

void append_edges(const Polygon& polygon, std::vector<Edge>& edges) {
  for_each_edge(polygon, [&](Point2 a, Point2 b) { edges.push_back({a, b}); });
}

std::string at(Point2 p) { return fmt::format("at {}, {}", p.x, p.y); }

bool is_oriented(const Polygon& polygon) {
  return signed_area(polygon.outer) > 0 &&
         std::all_of(polygon.holes.begin(), polygon.holes.end(),
                     [](const Ring& hole) { return signed_area(hole) < 0; });
}

}  // namespace

// The sum of the outlines' boundaries, as chains of edges, is the footprint's boundary. As each
// outline winds once around its inside and not at all around the rest, so does the footprint around
// each place, as often as there are outlines over it: once.
std::string tiling_fault(const Polygon& footprint, std::span<const RoofPart> parts) {
  std::vector<Edge> edges, outer;
  for (const RoofPart& part : parts) {
    if (part.outline.outer.size() < 3) return "have no area";
    if (!is_oriented(part.outline)) return "are turned round " + at(part.outline.outer[0]);
    if (!geos::is_valid({&part.outline, 1})) return "cross themselves " + at(part.outline.outer[0]);
    append_edges(part.outline, edges);
  }
  append_edges(footprint, outer);
  std::sort(edges.begin(), edges.end());
  std::sort(outer.begin(), outer.end());
  const auto twice = std::adjacent_find(edges.begin(), edges.end());
  if (twice != edges.end()) return "overlap " + at(twice->a);
  const auto has = [](const std::vector<Edge>& list, const Edge& edge) {
    return std::binary_search(list.begin(), list.end(), edge);
  };
  for (const Edge& edge : edges)
    if (has(edges, {edge.b, edge.a}) == has(outer, edge))
      return "meet neither each other nor the footprint " + at(edge.a);
  for (const Edge& edge : outer)
    if (!has(edges, edge)) return "leave out the footprint's edge " + at(edge.a);
  return "";
}

}  // namespace tetropolis
