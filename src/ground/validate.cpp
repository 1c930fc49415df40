#include "validate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/units.h"
#include "edge_table.h"
#include "geometry/predicates.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

bool full(const Violations& violations) { return violations.size() >= kMaxViolations; }

void append(Violations& to, Violations from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

Point2 at(std::span<const Point2> points, VertexIndex v) { return points[v]; }

std::array<Point2, 3> corners(std::span<const Point2> points, const std::array<VertexIndex, 3>& t) {
  return {at(points, t[0]), at(points, t[1]), at(points, t[2])};
}

double largest_coordinate(std::span<const Point2> points) {
  double largest = 0;
  for (const Point2& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  return largest;
}

// A corner of the segments sharper than some angle: apex and one further point on each side.
struct SharpCorner {
  Point2 apex;
  Point2 right;
  Point2 left;
};

std::vector<SharpCorner> sharp_corners(std::span<const Point2> points, SegmentSpan segments,
                                       double limit) {
  const RaggedArray<VertexIndex> joined = neighbours(points.size(), segments);
  std::vector<SharpCorner> found;
  std::vector<std::pair<double, VertexIndex>> around;
  for (std::size_t v = 0; v < points.size(); ++v) {
    around.clear();
    for (const VertexIndex w : joined[v])
      around.emplace_back(std::atan2(at(points, w).y - points[v].y, at(points, w).x - points[v].x),
                          w);
    if (around.size() < 2) continue;
    std::sort(around.begin(), around.end());
    for (std::size_t i = 0; i < around.size(); ++i) {
      const Point2 p = at(points, around[i].second);
      const Point2 q = at(points, around[(i + 1) % around.size()].second);
      if (orient2d(points[v], p, q) > 0 && angle_between(points[v], p, q) < limit)
        found.push_back({points[v], p, q});
    }
  }
  return found;
}

bool on_ray(Point2 p, Point2 from, Point2 towards) {
  return angle_between(from, p, towards) < 1e-6;
}

// x and y on the two sides of a sharp corner, at the same distance, seen under an angle that is no
// sharper, nor than 30 degrees.
bool across(const std::vector<SharpCorner>& sharp, Point2 x, Point2 y, double seen_under) {
  // Found by trial: points are rounded, and edges at the corner are cut at shells that differ by
  // as much.
  constexpr double kShareOfSine = 0.997, kSameDistance = 0.002;
  return std::any_of(sharp.begin(), sharp.end(), [&](const SharpCorner& c) {
    const double dx = distance(c.apex, x), dy = distance(c.apex, y);
    if (std::abs(dx - dy) > kSameDistance * std::max(dx, dy)) return false;
    const double corner = angle_between(c.apex, c.right, c.left);
    if (std::sin(seen_under) < kShareOfSine * std::min(std::sin(corner), 0.5)) return false;
    return (on_ray(x, c.apex, c.right) && on_ray(y, c.apex, c.left)) ||
           (on_ray(y, c.apex, c.right) && on_ray(x, c.apex, c.left));
  });
}

}  // namespace

Violations check_topology(std::span<const Point2> points, TriangleSpan triangles) {
  Violations found;
  for (std::size_t t = 0; t < triangles.size() && !full(found); ++t) {
    const auto& v = triangles[t];
    if (std::any_of(v.begin(), v.end(), [&](VertexIndex i) { return i >= points.size(); })) {
      found.push_back(fmt::format("triangle {}: vertex out of range", t));
      return found;
    }
    const auto [a, b, c] = corners(points, v);
    if (orient2d(a, b, c) <= 0)
      found.push_back(fmt::format("triangle {}: not counter-clockwise", t));
  }
  const EdgeTable edges(triangles);
  std::vector<std::int32_t> balance(points.size(), 0);
  edges.for_each([&](std::span<const EdgeTable::Use> uses) {
    if (full(found)) return;
    if (uses.size() > 2 || (uses.size() == 2 && uses[0].forward == uses[1].forward))
      found.push_back(fmt::format("edge {}-{}: used {} times, or twice in one direction",
                                  uses[0].low.value(), uses[0].high.value(), uses.size()));
    if (uses.size() == 1) {
      balance[uses[0].low] += uses[0].forward ? 1 : -1;
      balance[uses[0].high] += uses[0].forward ? -1 : 1;
    }
  });
  for (std::size_t v = 0; v < balance.size() && !full(found); ++v)
    if (balance[v] != 0) found.push_back(fmt::format("vertex {}: the boundary ends there", v));
  return found;
}

Violations check_constrained_delaunay(std::span<const Point2> points, TriangleSpan triangles,
                                      SegmentSpan segments) {
  Violations found;
  const EdgeSet constrained(segments);
  std::size_t seen = 0;
  EdgeTable(triangles).for_each([&](std::span<const EdgeTable::Use> uses) {
    if (constrained.contains(uses[0].low, uses[0].high)) {
      ++seen;
      return;
    }
    if (full(found)) return;
    if (uses.size() != 2) {
      found.push_back(fmt::format("edge {}-{}: on the boundary, but not a segment",
                                  uses[0].low.value(), uses[0].high.value()));
      return;
    }
    const auto& t = triangles[uses[0].triangle];
    const auto& u = triangles[uses[1].triangle];
    const VertexIndex apex = u[uses[1].edge];
    const auto [a, b, c] = corners(points, t);
    if (incircle(a, b, c, at(points, apex)) > 0)
      found.push_back(fmt::format("edge {}-{}: not locally Delaunay", uses[0].low.value(),
                                  uses[0].high.value()));
  });
  if (seen != constrained.size())
    found.push_back(fmt::format("{} segments, but {} edges of triangles are segments",
                                constrained.size(), seen));
  return found;
}

Violations check_regions(TriangleSpan triangles, std::span<const std::int32_t> regions,
                         SegmentSpan segments) {
  Violations found;
  if (regions.size() != triangles.size()) {
    found.push_back(fmt::format("{} regions for {} triangles", regions.size(), triangles.size()));
    return found;
  }
  const EdgeSet constrained(segments);
  EdgeTable(triangles).for_each([&](std::span<const EdgeTable::Use> uses) {
    if (uses.size() != 2 || full(found) || constrained.contains(uses[0].low, uses[0].high)) return;
    const std::int32_t r = regions[uses[0].triangle];
    const std::int32_t s = regions[uses[1].triangle];
    if (r != s)
      found.push_back(
          fmt::format("triangles {} and {}: regions {} and {} without a segment between",
                      uses[0].triangle.value(), uses[1].triangle.value(), r, s));
  });
  return found;
}

Violations check_angles(std::span<const Point2> points, TriangleSpan triangles,
                        SegmentSpan segments, double min_angle_deg) {
  Violations found;
  const double limit = to_radians(min_angle_deg - 1e-6);
  const EdgeSet constrained(segments);
  const auto sharp = sharp_corners(points, segments, to_radians(min_angle_deg));
  for (std::size_t t = 0; t < triangles.size() && !full(found); ++t) {
    const auto& v = triangles[t];
    const auto p = corners(points, v);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const double angle = angle_between(p[i], p[j], p[k]);
      if (angle >= limit) continue;
      if (constrained.contains(v[i], v[j]) && constrained.contains(v[i], v[k])) continue;
      if (across(sharp, p[j], p[k], angle)) continue;
      found.push_back(fmt::format("triangle {}: angle of {:.6f} degrees at ({}, {})", t,
                                  to_degrees(angle), p[i].x, p[i].y));
    }
  }
  return found;
}

Violations check_edge_lengths(std::span<const Point2> points, TriangleSpan triangles,
                              double max_edge) {
  Violations found;
  for (std::size_t t = 0; t < triangles.size() && !full(found); ++t) {
    const auto p = corners(points, triangles[t]);
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = distance(p[i], p[(i + 1) % 3]);
      if (length > max_edge * (1 + 1e-9))
        found.push_back(
            fmt::format("triangle {}: edge of length {} at ({}, {})", t, length, p[i].x, p[i].y));
    }
  }
  return found;
}

Violations check_edge_lengths_at(std::span<const Point2> points, TriangleSpan triangles,
                                 std::span<const double> bounds) {
  Violations found;
  for (std::size_t t = 0; t < triangles.size() && !full(found); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = triangles[t][i], w = triangles[t][(i + 1) % 3];
      const double length = distance(at(points, v), at(points, w));
      const double bound = std::min(bounds[v], bounds[w]);
      if (length > bound * (1 + 1e-9))
        found.push_back(
            fmt::format("triangle {}: edge {}-{} of length {} at a segment that bounds "
                        "it to {}",
                        t, v.value(), w.value(), length, bound));
    }
  return found;
}

namespace {

// Edges within regions and a size field that have bounds of their own.
Violations check_sizes(const PlanarGraph& graph, const RefineOptions& options,
                       const Triangulation& mesh) {
  Violations found;
  std::map<std::int32_t, double> of_region;
  for (const RegionSeed& seed : graph.regions)
    if (seed.max_edge > 0) {
      double& bound = of_region.try_emplace(seed.marker, seed.max_edge).first->second;
      bound = std::min(bound, seed.max_edge);
    }
  const auto bound_at = [&](std::int32_t region, Point2 middle) {
    const auto own = of_region.find(region);
    double bound = own == of_region.end() ? kInfinity : own->second;
    if (const auto r = static_cast<std::size_t>(region); r < options.region_max_edge.size())
      bound = std::min(bound, options.region_max_edge[r]);
    return options.size_field ? std::min(bound, options.size_field(middle)) : bound;
  };
  for (std::size_t t = 0; t < mesh.triangles.size() && !full(found); ++t) {
    const auto p = corners(mesh.points, mesh.triangles[t]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 q = p[(i + 1) % 3];
      const double bound =
          bound_at(mesh.triangle_regions[t], {0.5 * (p[i].x + q.x), 0.5 * (p[i].y + q.y)});
      if (distance(p[i], q) > bound * (1 + 1e-9))
        found.push_back(fmt::format("triangle {}: edge of length {} at ({}, {}), where {} is asked",
                                    t, distance(p[i], q), p[i].x, p[i].y, bound));
    }
  }
  return found;
}

// Per point the least bound of the segments that it lies on.
std::vector<double> bounds_at_segments(const PlanarGraph& graph, const Triangulation& mesh) {
  std::vector<double> bounds(mesh.points.size(), kInfinity);
  for (std::size_t s = 0; s < mesh.segments.size(); ++s) {
    const std::int32_t input = mesh.segment_inputs[s];
    if (input < 0) continue;
    for (const VertexIndex v : mesh.segments[s]) {
      double& bound = bounds[v];
      bound = std::min(bound, graph.segment_max_edge[static_cast<std::size_t>(input)]);
    }
  }
  return bounds;
}

// Whether segments lead from `a` to `b` along the line, never back by more than the tolerance. All
// branches are tried: near a crossing several vertices may be within the tolerance.
bool follows(std::span<const Point2> points, const RaggedArray<VertexIndex>& joined, VertexIndex a,
             VertexIndex b, double tolerance) {
  const Point2 from = at(points, a), to = at(points, b);
  const double length = distance(from, to);
  const auto along = [&](Point2 p) {
    return ((p.x - from.x) * (to.x - from.x) + (p.y - from.y) * (to.y - from.y)) / length;
  };
  std::vector<VertexIndex> open{a};
  std::set<VertexIndex> seen{a};
  while (!open.empty()) {
    const VertexIndex v = open.back();
    open.pop_back();
    if (v == b) return true;
    for (const VertexIndex w : joined[v]) {
      const Point2 p = at(points, w);
      if (along(p) >= along(at(points, v)) - tolerance &&
          distance_to_segment(p, from, to) <= tolerance && seen.insert(w).second)
        open.push_back(w);
    }
  }
  return false;
}

}  // namespace

Violations check_input(const PlanarGraph& graph, const Triangulation& triangulation) {
  Violations found;
  const std::span<const Point2> points = triangulation.points;
  if (triangulation.input_vertex.size() != graph.points.size())
    return {"input_vertex does not have one entry per input point"};
  for (std::size_t i = 0; i < graph.points.size() && !full(found); ++i)
    if (!(at(points, triangulation.input_vertex[i]) == graph.points[i]))
      found.push_back(fmt::format("point {}: has moved", i));
  std::vector<char> used(points.size(), 0);
  for (const auto& t : triangulation.triangles)
    for (const VertexIndex v : t) used[v] = 1;
  for (const auto& s : triangulation.segments)
    for (const VertexIndex v : s) used[v] = 1;
  const RaggedArray<VertexIndex> joined = neighbours(points.size(), triangulation.segments);
  const double tolerance = kOnSegmentTolerance * largest_coordinate(points);
  for (std::size_t s = 0; s < graph.segments.size() && !full(found); ++s) {
    const VertexIndex a = triangulation.input_vertex[graph.segments[s][0]];
    const VertexIndex b = triangulation.input_vertex[graph.segments[s][1]];
    if (used[a] == 0 || used[b] == 0) continue;
    if (!follows(points, joined, a, b, tolerance))
      found.push_back(fmt::format("segment {}: not a chain of edges", s));
  }
  return found;
}

Violations validate(const PlanarGraph& graph, const Triangulation& triangulation) {
  const auto& t = triangulation;
  Violations found = check_topology(t.points, t.triangles);
  if (!found.empty()) return found;
  if (!t.triangles.empty())
    append(found, check_constrained_delaunay(t.points, t.triangles, t.segments));
  append(found, check_regions(t.triangles, t.triangle_regions, t.segments));
  append(found, check_input(graph, t));
  return found;
}

Violations validate(const PlanarGraph& graph, const RefineOptions& options,
                    const Triangulation& triangulation) {
  const auto& t = triangulation;
  Violations found = validate(graph, t);
  if (!found.empty()) return found;
  append(found, check_angles(t.points, t.triangles, t.segments, options.min_angle_deg));
  if (options.max_edge > 0)
    append(found, check_edge_lengths(t.points, t.triangles, options.max_edge));
  if (!graph.regions.empty() || options.size_field) append(found, check_sizes(graph, options, t));
  if (!graph.segment_max_edge.empty())
    append(found, check_edge_lengths_at(t.points, t.triangles, bounds_at_segments(graph, t)));
  return found;
}

AngleStatistics angle_statistics(std::span<const Point2> points, TriangleSpan triangles) {
  if (triangles.empty()) return {};
  AngleStatistics all = parallel_reduce_ordered(
      triangles.size(), 4096, AngleStatistics{180, 0},
      [&](std::size_t begin, std::size_t end) {
        AngleStatistics some{180, 0};
        for (const auto& v : triangles.subspan(begin, end - begin)) {
          const auto p = corners(points, v);
          double smallest = 180;
          for (std::size_t i = 0; i < 3; ++i)
            smallest =
                std::min(smallest, to_degrees(angle_between(p[i], p[(i + 1) % 3], p[(i + 2) % 3])));
          some.min_deg = std::min(some.min_deg, smallest);
          some.mean_min_deg += smallest;
        }
        return some;
      },
      [](const AngleStatistics& a, const AngleStatistics& b) {
        return AngleStatistics{std::min(a.min_deg, b.min_deg), a.mean_min_deg + b.mean_min_deg};
      });
  all.mean_min_deg /= static_cast<double>(triangles.size());
  return all;
}

}  // namespace tetropolis
