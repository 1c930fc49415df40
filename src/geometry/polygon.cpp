#include "tetropolis/geometry/polygon.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "core/infinity.h"
#include "core/sort_once.h"

namespace tetropolis {

double signed_area(const Ring& ring) {
  if (ring.size() < 3) return 0;
  // Relative to the first vertex, so that large coordinates do not cancel.
  const Point2 o = ring[0];
  double twice = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    twice += (ring[i].x - o.x) * (ring[i + 1].y - o.y) - (ring[i + 1].x - o.x) * (ring[i].y - o.y);
  return twice / 2;
}

double area(const Polygon& polygon) {
  double result = std::abs(signed_area(polygon.outer));
  for (const Ring& hole : polygon.holes) result -= std::abs(signed_area(hole));
  return result;
}

double total_area(std::span<const Polygon> polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area(polygon);
  return sum;
}

Bounds2 bounds(std::span<const Point2> points) {
  Bounds2 box = Bounds2::nothing();
  for (const Point2 p : points) box.extend(p);
  return box;
}

Bounds2 bounds(const Polygon& polygon) { return bounds(polygon.outer); }

Polygon rectangle(const Bounds2& box) {
  assert(!box.empty());
  return {{{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}},
          {}};
}

std::vector<const Polygon*> pointers_to(std::span<const Polygon> polygons) {
  std::vector<const Polygon*> pointers;
  pointers.reserve(polygons.size());
  for (const Polygon& polygon : polygons) pointers.push_back(&polygon);
  return pointers;
}

const Polygon& largest(std::span<const Polygon> polygons) {
  assert(!polygons.empty());
  return *std::max_element(polygons.begin(), polygons.end(),
                           [](const Polygon& a, const Polygon& b) { return area(a) < area(b); });
}

bool contains(const Polygon& polygon, Point2 p) {
  bool inside = false;
  for_each_edge(polygon, [&](Point2 a, Point2 b) { inside ^= crosses_ray(a, b, p); });
  return inside;
}

double distance_to_segment(Point2 p, Point2 a, Point2 b) {
  return std::sqrt(squared_distance_to_segment(p, a, b));
}

double distance_to_boundary(const Polygon& polygon, Point2 p) {
  double squared = kInfinity;
  for_each_edge(polygon, [&](Point2 a, Point2 b) {
    squared = std::min(squared, squared_distance_to_segment(p, a, b));
  });
  return std::sqrt(squared);
}

namespace {

/// A stretch of a horizontal line inside a polygon.
struct Run {
  Point2 middle;
  double width = -1;
};

/// The widest run of the line at ordinate y; width -1 if the line misses the polygon.
Run widest_run(const Polygon& polygon, double y, std::vector<double>& crossings) {
  crossings.clear();
  for_each_edge(polygon, [&](Point2 a, Point2 b) {
    if ((a.y > y) == (b.y > y)) return;
    if (a.y > b.y) std::swap(a, b);
    crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
  });
  std::sort(crossings.begin(), crossings.end());
  Run best;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const double width = crossings[i + 1] - crossings[i];
    if (width > best.width) best = {{crossings[i] + width / 2, y}, width};
  }
  return best;
}

bool strictly_inside(const Polygon& polygon, const Run& run) {
  return run.width > 0 && contains(polygon, run.middle) &&
         distance_to_boundary(polygon, run.middle) > 0;
}

/// The ordinates of all vertices, ascending, each once.
std::vector<double> ordinates(const Polygon& polygon) {
  std::vector<double> ys;
  for_each_edge(polygon, [&](Point2, Point2 b) { ys.push_back(b.y); });
  sort_once(ys);
  return ys;
}

}  // namespace

Point2 interior_point(const Polygon& polygon) {
  const Bounds2 box = bounds(polygon);
  const Point2 centre{box.xmin + box.width() / 2, box.ymin + box.height() / 2};
  const std::vector<double> ys = ordinates(polygon);
  if (ys.size() < 2) return centre;
  const auto middle_of_slab = [&](std::size_t k) { return ys[k] + (ys[k + 1] - ys[k]) / 2; };
  // The slab that holds the centre; the centre is below the last ordinate unless rounding says so.
  const auto above = std::upper_bound(ys.begin() + 1, ys.end() - 1, centre.y);
  std::vector<double> crossings;
  const Run usual = widest_run(
      polygon, middle_of_slab(static_cast<std::size_t>(above - ys.begin()) - 1), crossings);
  if (strictly_inside(polygon, usual)) return usual.middle;
  Run best;
  for (std::size_t k = 0; k + 1 < ys.size(); ++k) {
    const Run run = widest_run(polygon, middle_of_slab(k), crossings);
    if (run.width > best.width && strictly_inside(polygon, run)) best = run;
  }
  return best.width > 0 ? best.middle : centre;
}

}  // namespace tetropolis
