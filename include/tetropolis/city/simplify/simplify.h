// Step 2.1 and 2.2: footprints that are closer than a threshold are merged, and every footprint is
// repaired until all its features are that far apart (guarantees 1 and 2).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct SimplifyOptions {
  double min_distance = 1.0;  ///< Epsilon, metres; 0.01 to 1000.
  int growths = 3;            ///< How many reaches are tried for gap fills that join polygons:
                              ///< the distance, twice that, and so on; >= 1.
  double min_area = 15;       ///< Square metres; smaller results are dropped.
  double close_gaps = 0;      ///< Metres: slots and courtyards that are narrower than this and
                              ///< lead nowhere are filled; up to min_distance: no others than are
                              ///< anyway.
  double parallel_tolerance =
      0.01;  ///< Radians; edges closer in direction count as parallel (2.2).
};

/// How far an output is from the union of its members, these already cut back from the domain's
/// boundary (what lies outside is no error of the simplification). Where a repair has parted
/// members that overlap, what they have in common counts for one of them.
struct FootprintChange {
  double symmetric_difference = 0;  ///< Its area, square metres.
  double hausdorff_distance = 0;    ///< Of the two regions, symmetric; metres, to a centimetre.
  Point2 at;                        ///< Where that is: a point of one, farthest from the other.
};

/// An input footprint that is in no output, and why (one short clause).
struct DroppedFootprint {
  BuildingIndex index;
  std::string reason;
  DropCause cause = DropCause::kUnusable;
};

struct SimplifyStats {
  double area_before = 0;  ///< Of the union of all members and of what is dropped, square metres.
  double area_after = 0;   ///< Of all output footprints.
  double symmetric_difference = 0;  ///< Between the two, dropped ones included.
  double area_dropped = 0;  ///< Part of symmetric_difference: of input that is in no output.
  double max_hausdorff_distance = 0;  ///< Largest of all footprints.
  std::int64_t hulls = 0;             ///< Outputs with the flag kConvexHull.

  std::int64_t groups = 0;           ///< Groups closer than epsilon in the input, single ones too.
  std::int64_t merged_by_union = 0;  ///< Groups of several, by the resort that joined them.
  std::vector<std::int64_t>
      merged_by_gap_fill;             ///< Index k: with gap fills of the k-th reach, from 1.
  std::int64_t merged_by_bridge = 0;  ///< By boxes across the narrowest places.
  std::int64_t merged_by_hulls = 0;   ///< By the union of the parts' convex hulls.
  std::int64_t merged_by_hull = 0;    ///< By the convex hull of all.
  std::int64_t merged_late = 0;       ///< Groups fewer, by joining what gap fills and repairs had
                                      ///< brought close.

  std::int64_t vertices_dropped = 0;
  std::int64_t edges_merged = 0;  ///< Short edges replaced by one vertex.
  std::int64_t edges_slid = 0;    ///< Short edges lengthened along the adjoining walls.
  std::int64_t vertices_moved = 0;
  std::int64_t holes_filled = 0;      ///< Courtyards filled by repairs of vertices.
  std::int64_t gaps_filled = 0;       ///< Gap fills put into gaps, notches and slots.
  std::int64_t dead_ends_closed = 0;  ///< Fills of SimplifyOptions::close_gaps, gaps_filled too.
  std::int64_t arms_cut = 0;          ///< Gap fills taken out of necks and thin arms.
  std::int64_t necks_widened = 0;
  std::int64_t corners_chamfered = 0;  ///< Sharp corners that lost the tip that is too narrow.
  std::int64_t local_hulls = 0;        ///< Close pairs covered by the hull of their surroundings.
  std::int64_t hull_repairs = 0;  ///< Times that a whole outline was replaced by its convex hull.
  std::int64_t clipped = 0;       ///< Footprints cut back from the domain's boundary.
  int rounds = 0;                 ///< Rounds of repair until nothing was too close.
  double min_clearance = 0;       ///< joint_clearance of the outputs and the domain, metres.
};

struct Simplification {
  std::vector<Polygon> footprints;
  std::vector<std::vector<BuildingIndex>> members;  ///< Per footprint: the inputs it is made of.
  std::vector<std::uint32_t> flags;  ///< Per footprint: kMerged, kConvexHull, kRepaired, kClipped.
  std::vector<FootprintChange> changes;   ///< Per footprint.
  std::vector<DroppedFootprint> dropped;  ///< By index.
  SimplifyStats stats;
};

/// Merges and repairs footprints.
/// Preconditions: every polygon of `cleaned` is a result of clean_footprint (or of this function).
/// Coordinates and `domain` are metres, on the grid of kCoordinateStep, and within 1,000 km of
/// zero: beyond, numbers are too coarse for the nanometre of is_clear. Guarantees:
/// - every input index is in exactly one of `members` (each sorted) or in `dropped`;
/// - footprints are sorted by their first member; they pass footprint_defects, and
///   joint_clearance of all of them and `domain` is at least min_distance (see is_clear);
/// - every footprint is at least min_area large;
/// - buildings that a repair parts from each other (they hung together by something thin) go on as
///   footprints of their own, each with the members that it holds most of;
/// - the result does not depend on the number of threads; a second call on the result returns it
///   unchanged (with close_gaps: nearly always, as repairs may leave another slot);
/// - near-linear time, apart from the unions of large clusters.
///
/// kRepaired marks footprints whose outline is more than 2 cm off the union of the polygons that it
/// is made of, or that share such a polygon with others; kConvexHull, those of which a hull became
/// a part, at any stage; kMerged and kClipped follow from the members. Input that comes closer than
/// min_distance to the domain's boundary is cut back from it (or dropped, where less than half of
/// it would be left). What is cut off so is not counted as changed.
///
/// The method goes beyond Naserentin and Logg (2022), Algorithms 1 to 3, by taking two concerns
/// apart: polygons closer than min_distance are joined by union and gap fills (merge_polygons.h);
/// then features too close within one outline are repaired where they are (repair.h), and what that
/// leaves is filled, cut or widened by gap fills. A building that loses more than half of its area
/// so, because neither its wings nor its courtyards are wide enough, becomes a block without
/// courtyards, where that changes less. It ends because rounds are bounded: in the first
/// rounds gap fills reach twice as far each time; then places are covered by the hull of everything
/// within a distance that doubles; at last every group that still has too close features becomes
/// its convex hull, whose short edges drop away until it is clear or vanishes, and hulls that come
/// close to others unite with them to one hull, which lowers the number of groups each time. Last,
/// corners sharper than 13.5 degrees are filled or cut where they are narrower than min_distance
/// (chamfer.h), as far as clearance allows.
/// Throws Error(kUsage) for options out of range and for a domain that is no box along the axes,
/// Cancelled through `progress`.
Simplification simplify_footprints(std::span<const Polygon> cleaned, const Domain& domain,
                                   const SimplifyOptions& options, const Progress& progress = {});

}  // namespace tetropolis
