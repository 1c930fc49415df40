// Constrained Delaunay triangulation of a planar graph: points and segments in, triangles out.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// For one side of a segment: it marks no region.
inline constexpr std::int32_t kUnmarkedSide = std::numeric_limits<std::int32_t>::min();

/// Marker and input index of a subsegment of the convex hull that no input segment covers.
inline constexpr std::int32_t kHullSegment = -1;

/// Marks the region around `seed`, as far as segments bound it.
struct RegionSeed {
  Point2 seed;
  std::int32_t marker = 0;
  double max_edge = 0;  ///< Longest edge wanted in the region when refining; 0: no own bound.
};

/// What is to be triangulated. Points may repeat and lie on segments; segments may cross, overlap
/// and be single points.
struct PlanarGraph {
  std::vector<Point2> points;
  std::vector<std::array<VertexIndex, 2>> segments;  ///< Indices of `points`.
  std::vector<std::int32_t> segment_markers;         ///< Per segment, or empty: all 0.
  /// Per segment, or empty: the regions on its left and on its right, or kUnmarkedSide. Regions
  /// are flooded from these sides first, in segment order, and then from `regions`; so they do not
  /// depend on where a seed happens to fall.
  std::vector<std::array<std::int32_t, 2>> segment_sides;
  /// Per segment, or empty: longest edge wanted at its points when refining, on the segment and
  /// beside it; infinity: no own bound. Where segments overlap, that of the first one counts.
  std::vector<double> segment_max_edge;
  std::vector<Point2> holes;  ///< The area around each, as far as segments bound it, is left out.
  std::vector<RegionSeed> regions;
};

/// Numbering. Within a triangle, edge i is the one opposite to vertex i, so that it runs from
/// vertex i + 1 to vertex i + 2 (modulo 3), counter-clockwise:
///
///              v2
///             /  \          edge 0: v1 -> v2
///     edge 1 /    \ edge 0  edge 1: v2 -> v0
///           /      \        edge 2: v0 -> v1
///         v0 ------ v1
///            edge 2
///
/// Points: first the distinct input points in the order of their first mention, then crossings of
/// segments, then points added by refinement. A point may belong to no triangle (it lies in a hole,
/// all points are collinear, or refinement has added it and taken it away again).
struct Triangulation {
  std::vector<Point2> points;
  std::vector<std::array<VertexIndex, 3>> triangles;  ///< Counter-clockwise, positive area.
  std::vector<std::int32_t> triangle_regions;         ///< Per triangle; kNoRegion: not marked.
  /// The edges that input segments consist of, each once, directed as its segment. Where segments
  /// overlap, the first one is named. The boundary of the triangulated area always belongs to them.
  std::vector<std::array<VertexIndex, 2>> segments;
  std::vector<std::int32_t> segment_markers;   ///< Per subsegment: marker, or kHullSegment.
  std::vector<std::int32_t> segment_inputs;    ///< Per subsegment: input index, or kHullSegment.
  std::vector<VertexIndex> input_vertex;       ///< Per input point. Duplicates share a vertex.
  std::int64_t crossings = 0;                  ///< Points added where segments cross.
  std::int64_t small_input_angles = 0;         ///< Set by refinement: see refine.h.
  std::int64_t triangles_below_min_angle = 0;  ///< Set by refinement: see refine.h.
};

struct TriangulationOptions {
  /// True: keep all of the convex hull (less the holes). False: what can be reached from outside
  /// without crossing a segment is left out; a graph without segments keeps its hull all the same.
  bool convex_hull = false;
};

/// The constrained Delaunay triangulation of `graph`. Incremental insertion in a biased randomised
/// Hilbert order (Amenta, Choi, Rote 2003; Bowyer, Watson 1981 for the cavity), segments by flips
/// (Sloan 1993), with exact predicates throughout.
///
/// Guarantees: input points keep their coordinates bit for bit; every input segment is a union of
/// edges (less the stretches with a hole or the outside on both sides); no vertex lies inside the
/// circumcircle of a triangle from which it is visible. The same input gives the same bytes.
///
/// Crossing segments get a vertex where they cross. Its coordinates are rounded, so the pieces of
/// either segment may leave it by about one unit in the last place of the coordinates. Tolerance:
/// with e = 2^-46 times the largest coordinate of the segment, a segment that passes a vertex at a
/// distance of at most e is led through that vertex, and no crossing is added that near to a vertex
/// around it.
///
/// Throws Error(kInput) naming the point or the segment: a coordinate is not finite or larger than
/// 1e100 in magnitude, or, other than zero, smaller than 1e-100 or than 1e-100 times the largest;
/// an index is out of range; an array has the wrong length; segments among points that are nearer
/// to one another than e find no way between them (seen only there).
Triangulation constrained_delaunay(const PlanarGraph& graph,
                                   const TriangulationOptions& options = {});

}  // namespace tetropolis
