#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "core/mix64.h"
#include "ground/construct.h"
#include "ground/hilbert.h"

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
  double least = std::numeric_limits<double>::infinity(), most = 0;
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
    const std::uint64_t coins = mix64(i);  // a deterministic stand-in for tossed ones
    int round = kRounds;
    // A point moves to the round before with probability 1/8.
    while (round > 0 && ((coins >> (3 * (kRounds - round))) & 7U) == 0) --round;
    keys[i] = (static_cast<std::uint32_t>(round) << 28) | (curve(points[i]) >> 4);
  }
  return sorted_order(keys);
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
  const auto n = static_cast<std::int64_t>(graph.points.size());
  for (std::size_t i = 0; i < graph.segments.size(); ++i) {
    for (const VertexIndex v : graph.segments[i]) {
      if (v >= 0 && v < n) continue;
      throw Error(ErrorKind::kInput,
                  fmt::format("segment {}: there is no point {} (of {}); correct "
                              "the index",
                              i, v, n));
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
  const std::vector<Point2>& points = graph.points;
  TriMesh& mesh = result.mesh;
  const std::vector<std::int32_t> order = insertion_order(points);
  const auto at = [&](std::int32_t i) { return points[static_cast<std::size_t>(i)]; };

  // The vertex numbers are those of the input until duplicates are squeezed out at the end.
  mesh.points = points;
  mesh.triangles.reserve(points.size() * 2 + 16);
  mesh.tracking = true;
  std::vector<std::int32_t> same(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) same[i] = static_cast<std::int32_t>(i);

  std::size_t second = 1;
  while (second < order.size() && at(order[second]) == at(order[0])) ++second;
  std::size_t third = second + 1;
  while (third < order.size() && orient2d(at(order[0]), at(order[second]), at(order[third])) == 0)
    ++third;
  if (third < order.size()) {
    std::int32_t a = order[0], b = order[second], c = order[third];
    if (orient2d(at(a), at(b), at(c)) < 0) std::swap(b, c);
    mesh.start(a, b, c);
    std::int32_t hint = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k == 0 || k == second || k == third) continue;
      const std::int32_t v = order[k];
      const TriMesh::Location where = mesh.locate(at(v), hint);
      hint = where.triangle;
      if (where.vertex >= 0) {
        same[static_cast<std::size_t>(v)] = where.vertex;
        continue;
      }
      mesh.touched.clear();
      mesh.find_cavity(at(v), where.triangle);
      mesh.fill_cavity(v);
      hint = mesh.touched.back();
    }
  } else {
    // Collinear: equal points are found by sorting.
    std::vector<std::int32_t> sorted(order);
    std::sort(sorted.begin(), sorted.end(), [&](std::int32_t i, std::int32_t j) {
      const Point2 p = at(i), q = at(j);
      return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : i < j;
    });
    for (std::size_t k = 1; k < sorted.size(); ++k)
      if (at(sorted[k]) == at(sorted[k - 1]))
        same[static_cast<std::size_t>(sorted[k])] = same[static_cast<std::size_t>(sorted[k - 1])];
  }

  // Number distinct points by their first mention; `same` may name a later one of a group.
  std::vector<std::int32_t> number(points.size(), TriMesh::kNothing);
  result.input_vertex.resize(points.size());
  std::int32_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::int32_t& n = number[static_cast<std::size_t>(same[i])];
    if (n < 0) {
      n = count++;
      mesh.points[static_cast<std::size_t>(n)] = points[i];
    }
    result.input_vertex[i] = n;
  }
  mesh.points.resize(static_cast<std::size_t>(count));
  for (TriMesh::Triangle& t : mesh.triangles)
    for (std::int32_t& v : t.v)
      if (v >= 0) v = number[static_cast<std::size_t>(v)];
  mesh.some_triangle.assign(mesh.points.size(), TriMesh::kNothing);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t].v)
      if (v >= 0) mesh.some_triangle[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(t);
}

}  // namespace tetropolis
