// The plain types that every stage exchanges. Coordinates are metres in the local frame: the
// coordinates of the reference system minus the origin of the run (see city_model.h).
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "tetropolis/core/index.h"

namespace tetropolis {

/// 32 bits suffice for everything two-dimensional; nodes and cells have 64.
using VertexIndex = Index<struct VertexTag>;
using TriangleIndex = Index<struct TriangleTag>;
using BuildingIndex = Index<struct BuildingTag>;
using RegionIndex = Index<struct RegionTag>;

inline constexpr auto kNoVertex = VertexIndex::none();
inline constexpr auto kNoTriangle = TriangleIndex::none();
inline constexpr auto kNoBuilding = BuildingIndex::none();
inline constexpr auto kNoRegion = RegionIndex::none();

struct Point2 {
  double x = 0;
  double y = 0;
  friend bool operator==(const Point2&, const Point2&) = default;
};

/// x, y and elevation, or a vector in space.
using Point3 = std::array<double, 3>;

/// Closed box [xmin, xmax] x [ymin, ymax]. A box with xmin > xmax is empty.
struct Bounds2 {
  double xmin = 0;
  double ymin = 0;
  double xmax = 0;
  double ymax = 0;

  /// The box of no points, to be extended.
  static constexpr Bounds2 nothing() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {inf, inf, -inf, -inf};
  }
  void extend(const Bounds2& other) {
    xmin = std::min(xmin, other.xmin);
    ymin = std::min(ymin, other.ymin);
    xmax = std::max(xmax, other.xmax);
    ymax = std::max(ymax, other.ymax);
  }
  void extend(Point2 p) { extend(Bounds2{p.x, p.y, p.x, p.y}); }

  double width() const { return xmax - xmin; }
  double height() const { return ymax - ymin; }
  bool empty() const { return !(xmin <= xmax && ymin <= ymax); }
  bool contains(Point2 p) const { return p.x >= xmin && p.x <= xmax && p.y >= ymin && p.y <= ymax; }
  bool covers(const Bounds2& other) const {
    return other.xmin >= xmin && other.ymin >= ymin && other.xmax <= xmax && other.ymax <= ymax;
  }
  /// Empty where they do not intersect.
  Bounds2 intersection(const Bounds2& other) const {
    return {std::max(xmin, other.xmin), std::max(ymin, other.ymin), std::min(xmax, other.xmax),
            std::min(ymax, other.ymax)};
  }
  bool intersects(const Bounds2& other) const {
    return xmin <= other.xmax && other.xmin <= xmax && ymin <= other.ymax && other.ymin <= ymax;
  }
  Bounds2 grown(double margin) const {
    return {xmin - margin, ymin - margin, xmax + margin, ymax + margin};
  }
  Bounds2 moved(Point2 by) const { return {xmin + by.x, ymin + by.y, xmax + by.x, ymax + by.y}; }
  friend bool operator==(const Bounds2&, const Bounds2&) = default;
};

/// A closed ring: the last vertex is joined to the first and not repeated.
using Ring = std::vector<Point2>;

/// A polygon with holes. Once cleaned: the outer ring is counter-clockwise, holes are clockwise.
struct Polygon {
  Ring outer;
  std::vector<Ring> holes;
  friend bool operator==(const Polygon&, const Polygon&) = default;
};

}  // namespace tetropolis
