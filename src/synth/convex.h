// Cutting convex rings, for the street plan of synthetic cities. Rings are counter-clockwise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

#include "core/infinity.h"

// A namespace of its own, because vector operators are easily defined twice.
namespace tetropolis::convex {

inline Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
inline Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
inline Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
inline double dot(Point2 a, Point2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }
inline double length(Point2 a) { return std::sqrt(dot(a, a)); }
inline Point2 unit(Point2 a) { return (1 / length(a)) * a; }
inline Point2 left_of(Point2 a) { return {-a.y, a.x}; }

/// The part of a convex ring where normal . (p - through) >= 0; empty if there is none. The two
/// parts on either side of a line (normals n and -n) get the same new vertices, bit for bit.
inline Ring clip(const Ring& ring, Point2 through, Point2 normal) {
  Ring result;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i];
    const Point2 b = ring[(i + 1) % ring.size()];
    const double da = dot(normal, a - through);
    const double db = dot(normal, b - through);
    if (da >= 0) result.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) result.push_back(a + (da / (da - db)) * (b - a));
  }
  if (result.size() < 3) result.clear();
  return result;
}

/// The points of a convex ring at least `distance` from its boundary; empty if there are none.
inline Ring inset(const Ring& ring, double distance) {
  Ring result = ring;
  for (std::size_t i = 0; i < ring.size() && !result.empty(); ++i) {
    const Point2 inward = left_of(unit(ring[(i + 1) % ring.size()] - ring[i]));
    result = clip(result, ring[i] + distance * inward, inward);
  }
  return result;
}

/// How far `p` is inside a convex ring: the least distance to the lines of its edges, negative
/// outside. Edge number `skipped` (from vertex `skipped` to the next) does not count.
inline double depth_inside(const Ring& ring, Point2 p,
                           std::size_t skipped = std::numeric_limits<std::size_t>::max()) {
  double depth = kInfinity;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (i == skipped) continue;
    const Point2 inward = left_of(unit(ring[(i + 1) % ring.size()] - ring[i]));
    depth = std::min(depth, dot(inward, p - ring[i]));
  }
  return depth;
}

/// Drops vertices after which the ring's edge would be shorter than `shortest`, and nearly straight
/// corners. The result is convex and inside the ring.
inline Ring without_short_edges(Ring ring, double shortest) {
  for (std::size_t i = 0; i < ring.size() && ring.size() > 3;) {
    const Point2 before = ring[(i + ring.size() - 1) % ring.size()];
    const Point2 after = ring[(i + 1) % ring.size()];
    const bool is_short = length(after - ring[i]) < shortest;
    const bool straight =
        dot(unit(ring[i] - before), unit(after - ring[i])) > 0.99;  // Less than 8 degrees.
    if (is_short || straight) {
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    } else {
      ++i;
    }
  }
  return ring;
}

}  // namespace tetropolis::convex
