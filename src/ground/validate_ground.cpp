// The checks of a GroundMesh.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "edge_table.h"
#include "geometry/vec2.h"
#include "validate.h"

namespace tetropolis {

namespace {

using Segments = std::vector<std::array<VertexIndex, 2>>;

Point2 at(const GroundMesh& mesh, VertexIndex v) { return mesh.vertices[v]; }

// Edges of the boundary and edges between two regions, ascending.
Segments region_boundaries(const GroundMesh& mesh) {
  Segments segments;
  EdgeTable(mesh.triangles).for_each([&](std::span<const EdgeTable::Use> uses) {
    const auto region = [&](std::size_t i) { return mesh.region[uses[i].triangle]; };
    if (uses.size() == 1 || region(0) != region(1)) segments.push_back({uses[0].low, uses[0].high});
  });
  return segments;
}

// The tagged edges are those where regions change and those of the boundary, and lie where they
// say.
void check_tags(const GroundMesh& mesh, std::span<const Polygon> footprints, const Domain& domain,
                const Segments& segments, Violations& found) {
  const bool complete = std::equal(
      segments.begin(), segments.end(), mesh.tagged_edges.begin(), mesh.tagged_edges.end(),
      [](const auto& s, const TaggedEdge& e) { return s[0] == e.low && s[1] == e.high; });
  if (!complete) found.push_back("the tagged edges are not those that separate regions");
  std::vector<std::vector<std::array<Point2, 2>>> outlines(footprints.size() + 1);
  const auto note_edges = [](const Polygon& polygon, std::vector<std::array<Point2, 2>>& outline) {
    const auto note_ring = [&](const Ring& ring) {  // edge i begins at vertex i
      for (std::size_t i = 0; i < ring.size(); ++i)
        outline.push_back({ring[i], ring[(i + 1) % ring.size()]});
    };
    for_each_ring(polygon, note_ring);
  };
  for (std::size_t b = 0; b < footprints.size(); ++b) note_edges(footprints[b], outlines[b]);
  note_edges(domain.outline(), outlines.back());
  for (const TaggedEdge& edge : mesh.tagged_edges) {
    if (found.size() >= kMaxViolations) return;
    const bool on_side = edge.region == kNoRegion;
    const std::size_t r = on_side ? footprints.size() : edge.region;
    const auto s = static_cast<std::size_t>(edge.segment);
    if (r >= outlines.size() || s >= outlines[r].size() || (on_side && s >= mesh.sides.size())) {
      found.push_back(
          fmt::format("edge {}-{}: there is no such segment", edge.low.value(), edge.high.value()));
      continue;
    }
    const auto& [p, q] = outlines[r][s];
    double off = 0, largest = 0;
    for (const VertexIndex v : {edge.low, edge.high}) {
      off = std::max(off, on_side ? std::abs(domain.distance_to_side(s, at(mesh, v)))
                                  : distance_to_segment(at(mesh, v), p, q));
      largest = std::max({largest, std::abs(at(mesh, v).x), std::abs(at(mesh, v).y)});
    }
    const bool is_exact = on_side && domain.is_box();
    if (off > (is_exact ? 0 : kOnSegmentTolerance * largest))
      found.push_back(fmt::format("edge {}-{}: not on the segment it names", edge.low.value(),
                                  edge.high.value()));
  }
}

void check_domain(const GroundMesh& mesh, const Domain& domain, Violations& found) {
  double length = 0;
  for (const TaggedEdge& edge : mesh.tagged_edges) {
    if (edge.region != kNoRegion) continue;
    const Point2 a = at(mesh, edge.low), b = at(mesh, edge.high);
    length += distance(a, b);
  }
  double perimeter = 0;
  for (const auto& [from, to, patch] : domain.sides()) perimeter += distance(from, to);
  if (std::abs(length - perimeter) > 1e-9 * perimeter)
    found.push_back(fmt::format("boundary of length {} for a perimeter of {}", length, perimeter));
  double total = 0;
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) {
    const Point2 a = at(mesh, t[0]), b = at(mesh, t[1]), c = at(mesh, t[2]);
    total += 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    for (const VertexIndex v : t) used[v] = 1;
  }
  const double expected = domain.area();
  if (std::abs(total - expected) > 1e-9 * expected)
    found.push_back(fmt::format("triangles cover {} of {} square metres", total, expected));
  const auto unused = std::count(used.begin(), used.end(), 0);
  if (unused > 0) found.push_back(fmt::format("{} vertices belong to no triangle", unused));
}

// The triangles of each building add up to its footprint's area.
void check_areas(const GroundMesh& mesh, std::span<const Polygon> footprints, Violations& found) {
  std::vector<double> covered(footprints.size(), 0);
  for (const TriangleIndex t : mesh.triangles.indices()) {
    if (!mesh.inside_building(t)) continue;
    const BuildingIndex b = mesh.region_of(t).building;
    if (b >= footprints.size()) {
      found.push_back(fmt::format("triangle {}: there is no building {}", t.value(), b.value()));
      return;
    }
    const auto& v = mesh.triangles[t];
    covered[b] += signed_area({at(mesh, v[0]), at(mesh, v[1]), at(mesh, v[2])});
  }
  for (std::size_t b = 0; b < footprints.size() && found.size() < kMaxViolations; ++b) {
    const double expected = area(footprints[b]);
    if (std::abs(covered[b] - expected) > 1e-6 * (1 + expected))
      found.push_back(fmt::format("building {}: triangles cover {} of {} square metres", b,
                                  covered[b], expected));
  }
}

struct PointLess {
  bool operator()(Point2 p, Point2 q) const { return p.x != q.x ? p.x < q.x : p.y < q.y; }
};

// Also notes the least of the walls' bounds on edges, per vertex.
void check_footprints(const GroundMesh& mesh, std::span<const Polygon> footprints,
                      const Segments& segments, const GroundMeshOptions& options,
                      std::vector<double>& bounds, Violations& found) {
  std::map<Point2, VertexIndex, PointLess> vertices;
  double largest = 0;
  for (const VertexIndex v : mesh.vertices.indices()) {
    const Point2 p = mesh.vertices[v];
    vertices[p] = v;
    largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  }
  const double tolerance = kOnSegmentTolerance * largest;
  const RaggedArray<VertexIndex> joined = neighbours(mesh.vertices.size(), segments);
  for (const BuildingIndex b : indices<BuildingIndex>(footprints.size())) {
    for_each_edge(footprints[b], [&](Point2 p, Point2 q) {
      if (found.size() >= kMaxViolations) return;
      const auto from = vertices.find(p), to = vertices.find(q);
      if (from == vertices.end() || to == vertices.end()) {
        found.push_back(fmt::format("building {}: a corner is not a vertex", b.value()));
        return;
      }
      VertexIndex v = from->second;
      const double longest =
          options.wall_edge ? options.wall_edge(RegionIndex(b.value()), p, q) : kInfinity;
      const auto note = [&](VertexIndex w) { bounds[w] = std::min(bounds[w], longest); };
      note(v);
      while (v != to->second) {
        VertexIndex step = kNoVertex;
        double left = distance(at(mesh, v), q);
        for (const VertexIndex w : joined[v]) {
          const double rest = distance(at(mesh, w), q);
          if (rest >= left || distance_to_segment(at(mesh, w), p, q) > tolerance) continue;
          left = rest;
          step = w;
        }
        if (step == kNoVertex) {
          found.push_back(fmt::format("building {}: edge from ({}, {}) is not in the mesh",
                                      b.value(), p.x, p.y));
          return;
        }
        v = step;
        note(v);
      }
    });
  }
}

}  // namespace

Violations validate(const GroundMesh& mesh, std::span<const Polygon> footprints,
                    const Domain& domain, const GroundMeshOptions& options) {
  Violations found = check_topology(mesh.vertices, mesh.triangles);
  if (mesh.region.size() != mesh.triangles.size()) found.push_back("not one region per triangle");
  for (const RegionIndex r : mesh.region)
    if (r >= mesh.regions.size()) {
      found.push_back(fmt::format("there is no region {}", r.value()));
      break;
    }
  if (!found.empty()) return found;
  const Segments segments = region_boundaries(mesh);
  check_tags(mesh, footprints, domain, segments, found);
  check_domain(mesh, domain, found);
  check_areas(mesh, footprints, found);
  std::vector<double> bounds(mesh.vertices.size(), kInfinity);
  check_footprints(mesh, footprints, segments, options, bounds, found);
  for (const Violations& more :
       {check_constrained_delaunay(mesh.vertices, mesh.triangles, segments),
        check_angles(mesh.vertices, mesh.triangles, segments, options.min_angle_deg),
        check_edge_lengths(mesh.vertices, mesh.triangles,
                           std::max(options.mesh_size, options.grading.far_size)),
        check_edge_lengths_at(mesh.vertices, mesh.triangles, bounds)})
    found.insert(found.end(), more.begin(), more.end());
  return found;
}

}  // namespace tetropolis
