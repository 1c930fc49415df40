// Gentle repair of outlines: vertices are dropped, merged, slid along their walls or moved aside
// until no two features are closer than a distance.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

#include "city/outline.h"

namespace tetropolis {

/// Lengths in steps, areas in square steps.
struct RepairOptions {
  double epsilon = 0;             ///< Features closer than this are repaired.
  double max_cost = 0;            ///< Largest area one change may add and remove.
  Domain keep_inside;             ///< New vertices stay in it.
  double parallel_tolerance = 0;  ///< Radians; see tidy_vertices.
  double max_shift = 0;           ///< See tidy_vertices.
};

struct RepairCounts {
  std::int64_t dropped = 0;  ///< Vertices dropped.
  std::int64_t merged = 0;   ///< Short edges replaced by one vertex.
  std::int64_t slid = 0;     ///< Short edges lengthened by sliding their ends along the walls.
  std::int64_t moved = 0;    ///< Vertices moved away from an edge.
  std::int64_t filled = 0;   ///< Holes closed.
};

/// A vertex closer than epsilon to an edge it does not belong to (or, where that edge starts or
/// ends at a neighbour of the vertex, possibly a short edge).
struct NearPair {
  OutlineVertex vertex;
  OutlineVertex edge;
  double distance;
};

/// Drops vertices whose two edges differ in direction by less than parallel_tolerance and which are
/// within max_shift of the segment that replaces them, unless that brings features closer than
/// epsilon that were not. A vertex is judged by its present neighbours only, so that a second call
/// changes nothing.
void tidy_vertices(Outline& outline, const RepairOptions& options, RepairCounts& counts);

/// Applies changes of one or two neighbouring vertices, cheapest first, where the price of a change
/// is the area it adds and removes divided by its gain. The gain is the decrease of the potential
/// Phi = sum over all pairs closer than epsilon of (1.1 - distance / epsilon), pairs of different
/// polygons counting tenfold; a pair is an edge with its own ends, or a vertex with an edge it does
/// not belong to. Each change decreases Phi by at least a constant and no change ever increases it:
/// that is why it ends. No change makes edges cross or touch, nor sweeps over a vertex; so a valid
/// outline stays valid. The choice of changes by least area follows Visvalingam and Whyatt (1993),
/// "Line generalisation by repeated elimination of points".
/// Precondition: no two edges cross.
void repair_vertices(Outline& outline, const RepairOptions& options, RepairCounts& counts);

/// All pairs closer than epsilon, sorted by vertex then edge; short edges appear as pairs of their
/// end with the neighbouring edge.
std::vector<NearPair> near_pairs(const Outline& outline, double epsilon);

}  // namespace tetropolis
