#include "part_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "geometry/vec2.h"

namespace tetropolis {

namespace {

bool comes_before(Point2 a, Point2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); }

/// An edge as seen from its end `a`; every edge is there from both.
struct Ray {
  Point2 a, b;
  bool is_inside = false;  ///< Of two outlines.
};

std::vector<Ray> rays_of(std::span<const RoofPart> parts) {
  std::vector<Ray> rays;
  for (const RoofPart& part : parts)
    for_each_edge(part.outline, [&](Point2 a, Point2 b) {
      rays.push_back({a, b});
      rays.push_back({b, a});
    });
  std::sort(rays.begin(), rays.end(), [](const Ray& r, const Ray& s) {
    return std::tie(r.a.x, r.a.y, r.b.x, r.b.y) < std::tie(s.a.x, s.a.y, s.b.x, s.b.y);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (kept > 0 && rays[kept - 1].a == rays[i].a && rays[kept - 1].b == rays[i].b)
      rays[kept - 1].is_inside = true;
    else
      rays[kept++] = rays[i];
  }
  rays.resize(kept);
  return rays;
}

/// `around`: those of one corner.
void measure_angles(std::span<const Ray> around, LineClearance& clearance) {
  std::vector<std::pair<double, bool>> turned;
  for (const Ray& ray : around)
    turned.emplace_back(std::atan2(ray.b.y - ray.a.y, ray.b.x - ray.a.x), ray.is_inside);
  std::sort(turned.begin(), turned.end());
  turned.emplace_back(turned.front().first + 2 * std::numbers::pi, turned.front().second);
  for (std::size_t i = 1; i < turned.size(); ++i) {
    const double angle = turned[i].first - turned[i - 1].first;
    if (turned[i].second || turned[i - 1].second)
      clearance.angle = std::min(clearance.angle, angle);
  }
}

/// `corners`: each once, by x.
void measure_distances(const Ray& edge, const std::vector<Point2>& corners,
                       LineClearance& clearance) {
  const auto [low, high] = std::minmax(edge.a.x, edge.b.x);
  const double start = low - clearance.distance;
  auto it = std::lower_bound(corners.begin(), corners.end(), start,
                             [](Point2 p, double x) { return p.x < x; });
  for (; it != corners.end() && it->x <= high + clearance.distance; ++it) {
    if (*it != edge.a && *it != edge.b)
      clearance.distance = std::min(clearance.distance, distance_to_segment(*it, edge.a, edge.b));
  }
}

Ring without_junctions(const Ring& ring) {
  constexpr double kOnLine = 0.01;  // metres
  Ring kept;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 before = kept.empty() ? ring.back() : kept.back();
    if (distance_to_segment(ring[i], before, ring[(i + 1) % ring.size()]) > kOnLine)
      kept.push_back(ring[i]);
  }
  return kept.size() < 3 ? ring : kept;
}

}  // namespace

LineClearance line_clearance(std::span<const RoofPart> parts) {
  LineClearance clearance;
  const std::vector<Ray> rays = rays_of(parts);
  std::vector<Point2> corners;
  for (std::size_t i = 0, j = 0; i < rays.size(); i = j) {
    while (j < rays.size() && rays[j].a == rays[i].a) ++j;
    corners.push_back(rays[i].a);
    measure_angles(std::span(rays).subspan(i, j - i), clearance);
  }
  // Edges first: then searches end sooner.
  for (const Ray& ray : rays)
    clearance.distance = std::min(clearance.distance, distance(ray.a, ray.b));
  for (const Ray& ray : rays)
    if (comes_before(ray.a, ray.b)) measure_distances(ray, corners, clearance);
  return clearance;
}

Polygon without_junctions(const Polygon& footprint) {
  Polygon result;
  result.outer = without_junctions(footprint.outer);
  for (const Ring& hole : footprint.holes) result.holes.push_back(without_junctions(hole));
  return result;
}

}  // namespace tetropolis
