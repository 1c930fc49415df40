// From where terrain is to be excavated (excavate.h) so that cells and faces can be good.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

#include "excavate.h"
#include "volume/column/fill_columns.h"

namespace tetropolis {

/// `marked`, and 1 for the triangles that share a vertex with a marked one. One entry per triangle.
std::vector<std::uint8_t> with_neighbours(const ColumnMesh& mesh,
                                          std::span<const std::uint8_t> marked);

/// Marks buildings beside which a triangle outside buildings is bad and the ground rises above the
/// roof within it. Returns how many were not marked before. `plan` is the one `mesh` was made with;
/// `bad` has one entry per triangle; `marks.roofs` has its size.
std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan,
                               std::span<const std::uint8_t> bad, ExcavationMarks& marks);

/// Which vertices of a bad triangle become toes.
struct ToeRule {
  double slope = 1;  ///< Tangent; of triangles that are steeper,
  double share = 0;  ///< those in this share of the triangle's rise, from below. With a half, of a
                     ///< wall both ends: one may be far from what rises right before its middle.
};

/// For every bad triangle outside buildings: marks as toes, where their ground is, the vertices
/// that `rule` says; and, 15 degrees below the roof as seen from the other end of their longest
/// edge in it, its vertices on walls whose ground is higher. Returns how often that was not marked
/// before, or is lower now. `plan` is the one `mesh` was made with; `bad` has one entry per
/// triangle; `marks.toes` has its size.
std::int64_t mark_slope_toes(const ColumnMesh& mesh, const ColumnPlan& plan,
                             std::span<const std::uint8_t> bad, const ToeRule& rule,
                             ExcavationMarks& marks);

/// For every bad triangle outside buildings: marks its vertices as toes where their ground rises
/// more steeply than `slope` (tangent) from the edge opposite, or from a roof at its ends that it
/// is above, down to that slope. Returns how often. `plan` is the one `mesh` was made with; `bad`
/// has one entry per triangle; `marks.toes` has its size.
std::int64_t mark_gentle(const ColumnMesh& mesh, const ColumnPlan& plan,
                         std::span<const std::uint8_t> bad, double slope, ExcavationMarks& marks);

/// Marks the buildings (`marks.walls`) on whose walls a bad triangle outside buildings has a
/// vertex. Returns how many were not marked before. Sizes as above.
std::int64_t mark_deep_walls(const ColumnMesh& mesh, const ColumnPlan& plan,
                             std::span<const std::uint8_t> bad, ExcavationMarks& marks);

/// An excavation that was tried on a mesh: per vertex the elevation of the ground, per triangle
/// whether it was bad (MeasuredMesh::bad_triangles).
struct TriedExcavation {
  std::span<const double> ground_before, ground_after;
  std::span<const std::uint8_t> bad_before, bad_after;
};

/// Puts back as they were `before` the marks that did not help: those not at, nor next to, a
/// connected piece of lowered ground with fewer bad triangles after than before. `building` as from
/// lowest_roofs; `marks` are those of it, each list of its size or empty; the lists of
/// `before` are the same or empty.
void keep_helpful_marks(const ColumnMesh& mesh, std::span<const RegionIndex> building,
                        const TriedExcavation& tried, const ExcavationMarks& before,
                        ExcavationMarks& marks);

}  // namespace tetropolis
