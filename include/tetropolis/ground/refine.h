// Delaunay refinement: a triangulation with bounded angles and bounded edges.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/ground/triangulation.h"

namespace tetropolis {

struct RefineOptions {
  double min_angle_deg = 25;  ///< Degrees, 0 to 33. Always met up to 30 in our experience.
  double max_edge = 0;        ///< No edge is longer. 0: no bound.
  /// No edge is longer than the value at its midpoint, which must be positive. Empty: no bound.
  std::function<double(Point2)> size_field = {};
  /// Fill open areas with a lattice of nearly equilateral triangles before refining. Acts only
  /// where the size is `max_edge`.
  bool lattice = true;
  /// Move the added vertices that are on no segment where that widens the smallest angle around.
  bool optimize = true;
  /// Elevation of the terrain at a place, called by several threads at a time. Last of all, added
  /// vertices that are on no segment move by up to half an edge where triangles around are steeper
  /// than 72 degrees and that makes the steepest of them less steep. Empty: the terrain is not
  /// looked at.
  std::function<double(Point2)> elevation = {};
  /// Per region from 0: 1 if its floor is not the terrain, so that its triangles do not count.
  std::vector<std::uint8_t> off_terrain = {};
  /// Per region from 0: its longest edge; infinity: no own bound.
  std::vector<double> region_max_edge = {};
  bool convex_hull = false;  ///< As in TriangulationOptions.
  /// Give up beyond, and beyond 250 million in any case. 0: a bound from area, size and input.
  std::int64_t max_vertices = 0;
};

/// A constrained Delaunay triangulation of `graph` with vertices added so that
/// - no edge is longer than the smallest of `max_edge`, the region's max_edge and the size field,
///   nor, at a point on a segment, than the segment's max_edge;
/// - no angle is smaller than `min_angle_deg`, except in triangles that owe it to a corner of the
///   input sharper than that: at the corner itself, or across from it, with a shortest edge that
///   joins two points at the same distance from the corner, one on each of its sides, and no
///   sharper than the corner (or than 30 degrees). Such corners are counted in
///   `small_input_angles`, the triangles in `triangles_below_min_angle`. Input finer than the
///   precision of its coordinates can leave more of them, counted as well.
/// Guarantees of constrained_delaunay() hold, with the segments as they have been split: a point
/// added to a segment is rounded, so it may be off the line by one unit in the last place (never on
/// horizontal or vertical segments).
///
/// Method: Chew 1993 and Shewchuk 2002 ("Delaunay refinement algorithms for triangular mesh
/// generation"): bad triangles are split, patch by patch (of some thousands that are near each
/// other before they are refined) and the worst of a patch first, by an off-centre (Ungor 2004),
/// which is given up, and a subsegment split instead, if it falls beyond that subsegment or into
/// its diametral lens; free vertices in the diametral circle of a subsegment are removed before it
/// is split. Subsegments at corners sharper than 60 degrees are cut at radii that are equal on both
/// sides (concentric shells), and triangles behind the edges between equal radii of a corner that
/// is sharper than the minimum angle are left alone (Miller, Pav, Walkington 2003) where they are
/// no sharper than that corner: the two together end the refinement.
///
/// Throws Error(kInput) as constrained_delaunay() does, Error(kUsage) for options out of range,
/// Error(kGuarantee), naming a position, when `max_vertices` is exceeded, and Cancelled.
Triangulation refine(const PlanarGraph& graph, const RefineOptions& options,
                     const Progress& progress = {});

}  // namespace tetropolis
