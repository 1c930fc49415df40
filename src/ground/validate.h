// Checks of the guarantees of triangulations and ground meshes. Each returns one line per violation
// and nothing if there is none; after kMaxViolations lines a check stops. They share no code with
// the mesher except the exact predicates.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/ground/refine.h"
#include "tetropolis/ground/triangulation.h"

namespace tetropolis {

using Violations = std::vector<std::string>;
using TriangleSpan = std::span<const std::array<VertexIndex, 3>>;
using SegmentSpan = std::span<const std::array<VertexIndex, 2>>;

inline constexpr std::size_t kMaxViolations = 20;

/// How far a vertex on a segment may be from it: this times the largest coordinate.
inline constexpr double kOnSegmentTolerance = 0x1p-44;

/// Indices in range; triangles counter-clockwise (exact); every directed edge in one triangle, so
/// every edge in at most two and no triangle twice; at most one fan of triangles to a vertex
/// of the boundary on each side (the boundary's in- and out-degrees agree).
Violations check_topology(std::span<const Point2> points, TriangleSpan triangles);

/// Every segment is an edge; every other edge has two triangles and neither apex lies inside the
/// circumcircle of the other (exact). By Delaunay's lemma that is the constrained Delaunay property
/// of all of it. Precondition: check_topology() is empty.
Violations check_constrained_delaunay(std::span<const Point2> points, TriangleSpan triangles,
                                      SegmentSpan segments);

/// Triangles that share an edge which is not a segment have the same region.
Violations check_regions(TriangleSpan triangles, std::span<const std::int32_t> regions,
                         SegmentSpan segments);

/// No angle is below `min_angle_deg` (less 1e-6), except in a triangle that lies in a corner of
/// `segments` sharper than that, or whose shortest edge joins points at the same distance (to 0.2
/// %) from such a corner on its two sides, with an angle no sharper than the corner, or than 30
/// degrees (to 0.3 % of the sine).
Violations check_angles(std::span<const Point2> points, TriangleSpan triangles,
                        SegmentSpan segments, double min_angle_deg);

/// No edge is longer than `max_edge` (more than by rounding).
Violations check_edge_lengths(std::span<const Point2> points, TriangleSpan triangles,
                              double max_edge);

/// No edge at a vertex v is longer than `bounds[v]` (more than by rounding).
Violations check_edge_lengths_at(std::span<const Point2> points, TriangleSpan triangles,
                                 std::span<const double> bounds);

/// Input points are where input_vertex says, bit for bit; every input segment between vertices of
/// triangles or segments is a chain of segments of the triangulation that keeps to it
/// (kOnSegmentTolerance). Does not know about segments that go with a hole or with the
/// outside between two kept vertices.
Violations check_input(const PlanarGraph& graph, const Triangulation& triangulation);

/// Everything constrained_delaunay() guarantees.
Violations validate(const PlanarGraph& graph, const Triangulation& triangulation);

/// Everything refine() guarantees.
Violations validate(const PlanarGraph& graph, const RefineOptions& options,
                    const Triangulation& triangulation);

/// Everything mesh_ground() guarantees, but for the order of vertices and triangles: also that the
/// boundary is that of the domain, and that regions are bounded by the footprints and only by them.
Violations validate(const GroundMesh& mesh, std::span<const Polygon> footprints,
                    const Domain& domain, const GroundMeshOptions& options);

/// The angles of a mesh, for reports.
struct AngleStatistics {
  double min_deg = 0;
  double mean_min_deg = 0;  ///< Mean over triangles of the smallest angle.
};
AngleStatistics angle_statistics(std::span<const Point2> points, TriangleSpan triangles);

}  // namespace tetropolis
