#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "construct.h"
#include "core/infinity.h"
#include "geometry/hash_of.h"
#include "hilbert.h"

namespace tetropolis {

namespace {

bool usable(double value) { return std::isfinite(value) && std::abs(value) <= 1e100; }

void check_point(Point2 p, const char* role, std::size_t index) {
  if (usable(p.x) && usable(p.y)) return;
  throw Error(ErrorKind::kInput,
              fmt::format("{} {}: coordinates ({}, {}) are not finite or too large; remove it",
                          role, index, p.x, p.y));
}

// The exact predicates lose digits to underflow beyond this (predicates.h).
void check_spread(const PlanarGraph& graph) {
  constexpr double kLeast = 1e-100, kMostSpread = 1e100;
  double least = kInfinity, most = 0;
  const auto measure = [&](Point2 p) {
    for (const double value : {std::abs(p.x), std::abs(p.y)}) {
      if (value > 0) least = std::min(least, value);
      most = std::max(most, value);
    }
  };
  for (const Point2 p : graph.points) measure(p);
  for (const Point2 p : graph.holes) measure(p);
  for (const RegionSeed& region : graph.regions) measure(region.seed);
  if (most == 0 || (least >= kLeast && most / least <= kMostSpread)) return;
  throw Error(ErrorKind::kInput,
              fmt::format("a coordinate of magnitude {} beside one of {} is too small to be told "
                          "from zero; make it 0",
                          least, most));
}

// Rounds of growing size, each along the Hilbert curve: the coin tosses keep the expected work
// small for any input, the curve keeps walks short.
std::vector<std::int32_t> insertion_order(const std::vector<Point2>& points) {
  constexpr int kRounds = 15;
  const HilbertCurve curve(bounds(points));
  std::vector<std::uint32_t> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    // A deterministic stand-in for tossed ones, which no far point changes.
    const std::uint64_t coins = hash_of(points[i]);
    int round = kRounds;
    // A point moves to the round before with probability 1/8.
    while (round > 0 && ((coins >> (3 * (kRounds - round))) & 7U) == 0) --round;
    keys[i] = (static_cast<std::uint32_t>(round) << 28) | (curve(points[i]) >> 4);
  }
  return sorted_order(keys);
}

/// Points inserted by number; `same` leads from equal points to one of them.
struct Insertion {
  const std::vector<Point2>& points;
  std::vector<std::int32_t> order;
  std::vector<std::int32_t> same;

  Point2 at(std::int32_t i) const { return points[static_cast<std::size_t>(i)]; }
  std::int32_t& same_as(std::int32_t i) { return same[static_cast<std::size_t>(i)]; }
};

/// Places in `order` of the first point, and of the next that make a triangle with it; nothing if
/// all points are collinear.
std::optional<std::array<std::size_t, 3>> first_triangle(const Insertion& in) {
  const std::vector<std::int32_t>& order = in.order;
  std::size_t second = 1;
  while (second < order.size() && in.at(order[second]) == in.at(order[0])) ++second;
  std::size_t third = second + 1;
  while (third < order.size() &&
         orient2d(in.at(order[0]), in.at(order[second]), in.at(order[third])) == 0)
    ++third;
  if (third >= order.size()) return std::nullopt;
  return std::array<std::size_t, 3>{0, second, third};
}

void triangulate(Insertion& in, const std::array<std::size_t, 3>& first, TriMesh& mesh) {
  std::int32_t a = in.order[first[0]], b = in.order[first[1]], c = in.order[first[2]];
  if (orient2d(in.at(a), in.at(b), in.at(c)) < 0) std::swap(b, c);
  mesh.start(a, b, c);
  std::int32_t hint = 0;
  for (std::size_t k = 0; k < in.order.size(); ++k) {
    if (std::find(first.begin(), first.end(), k) != first.end()) continue;
    const std::int32_t v = in.order[k];
    const TriMesh::Location where = mesh.locate(in.at(v), hint);
    hint = where.triangle;
    if (where.vertex >= 0) {
      in.same_as(v) = where.vertex;
      continue;
    }
    mesh.touched.clear();
    mesh.find_cavity(in.at(v), where.triangle);
    mesh.fill_cavity(v);
    hint = mesh.touched.back();
  }
}

/// Of collinear points, which have no triangles: equal ones are found by sorting.
void find_equal(Insertion& in) {
  std::vector<std::int32_t> sorted(in.order);
  std::sort(sorted.begin(), sorted.end(), [&](std::int32_t i, std::int32_t j) {
    const Point2 p = in.at(i), q = in.at(j);
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : i < j;
  });
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (in.at(sorted[k]) == in.at(sorted[k - 1])) in.same_as(sorted[k]) = in.same_as(sorted[k - 1]);
}

/// Numbers distinct points by their first mention; `same` may name a later one of a group.
void number_distinct(const Insertion& in, Construction& result) {
  const std::vector<Point2>& points = in.points;
  TriMesh& mesh = result.mesh;
  std::vector<std::int32_t> number(points.size(), TriMesh::kNothing);
  result.input_vertex.resize(points.size());
  std::int32_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::int32_t& n = number[static_cast<std::size_t>(in.same[i])];
    if (n < 0) {
      n = count++;
      mesh.point(n) = points[i];
    }
    result.input_vertex[i] = VertexIndex(n);
  }
  mesh.points.resize(static_cast<std::size_t>(count));
  for (TriMesh::Triangle& t : mesh.triangles)
    for (std::int32_t& v : t.v)
      if (v >= 0) v = number[static_cast<std::size_t>(v)];
}

void find_some_triangles(TriMesh& mesh) {
  mesh.some_triangle.assign(mesh.points.size(), TriMesh::kNothing);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t].v)
      if (v >= 0) mesh.some_triangle_at(v) = static_cast<std::int32_t>(t);
}

}  // namespace

void check_graph(const PlanarGraph& graph) {
  if (static_cast<std::int64_t>(graph.points.size()) > kMostVertices)
    throw Error(ErrorKind::kInput, fmt::format("{} points; at most {} can be triangulated at once",
                                               graph.points.size(), kMostVertices));
  for (std::size_t i = 0; i < graph.points.size(); ++i) check_point(graph.points[i], "point", i);
  for (std::size_t i = 0; i < graph.holes.size(); ++i) check_point(graph.holes[i], "hole", i);
  for (std::size_t i = 0; i < graph.regions.size(); ++i)
    check_point(graph.regions[i].seed, "region", i);
  check_spread(graph);
  const std::size_t n = graph.points.size();
  for (std::size_t i = 0; i < graph.segments.size(); ++i) {
    for (const VertexIndex v : graph.segments[i]) {
      if (v < n) continue;
      throw Error(ErrorKind::kInput,
                  fmt::format("segment {}: there is no point {} (of {}); correct "
                              "the index",
                              i, v.value(), n));
    }
  }
  const auto check_size = [&](std::size_t size, const char* name) {
    if (size == 0 || size == graph.segments.size()) return;
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {} entries for {} segments; give one each or none", name, size,
                            graph.segments.size()));
  };
  check_size(graph.segment_markers.size(), "segment_markers");
  check_size(graph.segment_sides.size(), "segment_sides");
  check_size(graph.segment_max_edge.size(), "segment_max_edge");
}

void insert_points(const PlanarGraph& graph, Construction& result) {
  Insertion in{graph.points, insertion_order(graph.points), {}};
  in.same.resize(graph.points.size());
  std::iota(in.same.begin(), in.same.end(), 0);
  // The vertex numbers are those of the input until duplicates are squeezed out at the end.
  result.mesh.points = graph.points;
  result.mesh.triangles.reserve(graph.points.size() * 2 + 16);
  result.mesh.tracking = true;
  if (const auto first = first_triangle(in))
    triangulate(in, *first, result.mesh);
  else
    find_equal(in);
  number_distinct(in, result);
  find_some_triangles(result.mesh);
}

}  // namespace tetropolis
