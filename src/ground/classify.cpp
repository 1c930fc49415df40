#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "construct.h"
#include "hilbert.h"

namespace tetropolis {

namespace {

bool inside(const TriMesh::Triangle& x) {
  return x.v[0] != TriMesh::kDead && x.region != kOutsideRegion;
}

// Neither outside nor marked yet.
constexpr std::int32_t kUnvisited = kUnmarkedSide;

// Gives `region` to every unvisited triangle that `seed` reaches without crossing a segment.
void flood(TriMesh& mesh, std::int32_t seed, std::int32_t region,
           std::vector<std::int32_t>& stack) {
  if (mesh.tri(seed).region != kUnvisited) return;
  mesh.tri(seed).region = region;
  stack.assign(1, seed);
  while (!stack.empty()) {
    const std::int32_t t = stack.back();
    stack.pop_back();
    for (const std::int32_t n : mesh.tri(t).n) {
      if (n < 0 || mesh.tri(n >> 2).region != kUnvisited) continue;
      mesh.tri(n >> 2).region = region;
      stack.push_back(n >> 2);
    }
  }
}

// Hull edges become subsegments, so that the outside is the ghosts alone.
void close_hull(TriMesh& mesh) {
  const auto count = static_cast<std::int32_t>(mesh.triangles.size());
  for (std::int32_t t = 0; t < count; ++t) {
    if (!mesh.ghost(t)) continue;
    const TriMesh::Triangle& x = mesh.tri(t);
    const int g = x.v[0] < 0 ? 0 : x.v[1] < 0 ? 1 : 2;
    mesh.constrain(mesh.across(4 * t + g), kHullSegment);
  }
}

}  // namespace

void classify(const PlanarGraph& graph, bool convex_hull, Construction& result) {
  TriMesh& mesh = result.mesh;
  if (mesh.triangles.empty()) return;
  std::vector<std::int32_t> stack;
  for (TriMesh::Triangle& t : mesh.triangles) t.region = kUnvisited;
  if (convex_hull || mesh.subsegments.empty()) close_hull(mesh);
  const auto count = static_cast<std::int32_t>(mesh.triangles.size());
  for (std::int32_t t = 0; t < count; ++t)
    if (mesh.ghost(t)) flood(mesh, t, kOutsideRegion, stack);
  std::int32_t hint = 0;
  const auto locate = [&](Point2 p) {
    const std::int32_t t = mesh.locate(p, hint).triangle;
    hint = t;
    return t;
  };
  for (const Point2& hole : graph.holes) flood(mesh, locate(hole), kOutsideRegion, stack);
  if (!graph.segment_sides.empty()) {
    for (const TriMesh::Subsegment& s : mesh.subsegments) {
      if (s.v[0] == TriMesh::kDead || s.piece < 0) continue;
      const auto& sides = graph.segment_sides[static_cast<std::size_t>(s.piece)];
      for (std::size_t k = 0; k < 2; ++k)
        if (sides[k] != kUnmarkedSide) flood(mesh, s.side[k] >> 2, sides[k], stack);
    }
  }
  for (const RegionSeed& region : graph.regions)
    flood(mesh, locate(region.seed), region.marker, stack);
  for (TriMesh::Triangle& t : mesh.triangles)
    if (t.region == kUnvisited) t.region = kNoRegion.value();
}

void carve_outside(TriMesh& mesh) {
  if (mesh.triangles.empty()) return;  // collinear points, whose segments stay
  std::vector<std::int32_t> number(mesh.triangles.size());
  std::int32_t count = 0;
  for (std::size_t t = 0; t < number.size(); ++t)
    number[t] = inside(mesh.triangles[t]) ? count++ : TriMesh::kNothing;
  mesh.renumber(number);
}

void carve_along_curve(TriMesh& mesh) {
  if (mesh.triangles.empty()) return;  // collinear points, whose segments stay
  const HilbertCurve curve(bounds(mesh.points));
  std::vector<std::int32_t> kept;
  std::vector<std::uint32_t> places;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriMesh::Triangle& x = mesh.triangles[t];
    if (!inside(x)) continue;
    const Point2 a = mesh.point(x.v[0]), b = mesh.point(x.v[1]), c = mesh.point(x.v[2]);
    kept.push_back(static_cast<std::int32_t>(t));
    places.push_back(curve({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}));
  }
  const std::vector<std::int32_t> order = sorted_order(places);
  std::vector<std::int32_t> number(mesh.triangles.size(), TriMesh::kNothing);
  for (std::size_t k = 0; k < order.size(); ++k)
    number[static_cast<std::size_t>(kept[static_cast<std::size_t>(order[k])])] =
        static_cast<std::int32_t>(k);
  mesh.renumber(number);
}

Construction construct(const PlanarGraph& graph, bool convex_hull) {
  check_graph(graph);
  Construction result;
  insert_points(graph, result);
  insert_segments(graph, result);
  classify(graph, convex_hull, result);
  return result;
}

Triangulation export_triangulation(const PlanarGraph& graph, const Construction& construction,
                                   const std::vector<std::int32_t>& piece_input) {
  const TriMesh& mesh = construction.mesh;
  Triangulation out;
  out.points = mesh.points;
  out.input_vertex = construction.input_vertex;
  out.crossings = construction.crossings;
  out.triangles.reserve(mesh.triangles.size());
  out.triangle_regions.reserve(mesh.triangles.size());
  for (const TriMesh::Triangle& t : mesh.triangles) {
    if (t.v[0] == TriMesh::kDead) continue;
    out.triangles.push_back({VertexIndex(t.v[0]), VertexIndex(t.v[1]), VertexIndex(t.v[2])});
    out.triangle_regions.push_back(t.region);
  }
  for (const TriMesh::Subsegment& s : mesh.subsegments) {
    if (s.v[0] == TriMesh::kDead) continue;
    const std::int32_t input =
        piece_input.empty() ? s.piece : piece_input[static_cast<std::size_t>(s.piece)];
    out.segments.push_back({VertexIndex(s.v[0]), VertexIndex(s.v[1])});
    out.segment_inputs.push_back(input);
    out.segment_markers.push_back(input < 0 ? kHullSegment
                                  : graph.segment_markers.empty()
                                      ? 0
                                      : graph.segment_markers[static_cast<std::size_t>(input)]);
  }
  return out;
}

Triangulation constrained_delaunay(const PlanarGraph& graph, const TriangulationOptions& options) {
  Construction construction = construct(graph, options.convex_hull);
  carve_outside(construction.mesh);
  return export_triangulation(graph, construction, {});
}

}  // namespace tetropolis
