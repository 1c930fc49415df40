// Terrain cut back around roofs that lie below it, and from the feet of cliffs and low walls.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/cell_quality.h"
#include "tetropolis/volume/column_mesh.h"

namespace tetropolis {

struct ColumnPlan;  // fill_columns.h

/// How steeply ground may rise where it is cut back; tangents, > 0.
struct CutSlopes {
  double at_start = 1.4825609685127403;  ///< In the triangles at the roof's edge or the cliff's
                                         ///< foot; 56 degrees.
  double beyond = 2.475;                 ///< Further away, if that is more; 68 degrees.
};

/// From where the terrain is to be cut back.
struct CutMarks {
  std::vector<std::uint8_t> roofs;  ///< Per building, 1: from the edge of its roof.
  std::vector<double> feet;         ///< Per vertex, elevation of the foot of a cliff or of a wall;
                                    ///< infinity: none.

  bool any() const { return !roofs.empty() || !feet.empty(); }
};

/// From where it was: from each of these something was lowered.
struct CutSources {
  std::vector<BuildingIndex> roofs;  ///< Ascending.
  std::vector<Point3> feet;          ///< By vertex; z as marked.
};

/// Lowers `ground` at vertices outside buildings and on walls, until it rises no more steeply than
/// `slopes` say from the roof's edge of a marked building, from a marked foot (which itself is at
/// most at its elevation), or from ground that was lowered so (to a micrometre). Distances are
/// those in the triangles outside buildings. Where the terrain dips below that, nothing beyond is
/// touched; a hillside steeper than `slopes.beyond` is cut back to its crest. `ground`: elevation
/// per vertex; `building` as from vertex_buildings; `roofs`: elevation per building; `marks`: each
/// list of its size, or empty.
CutSources cut_back(const GroundMesh& mesh, std::span<const BuildingIndex> building,
                    std::span<const double> roofs, const CutMarks& marks, const CutSlopes& slopes,
                    std::vector<double>& ground);

/// 1 for the triangles over which a cell is outside the bounds, or over which (or over an edge of
/// which) a face is more than kMostNonOrthogonal; for marking.
std::vector<std::uint8_t> find_bad_triangles(const ColumnMesh& mesh, const AngleBounds& bounds);

/// Marks buildings beside which a triangle outside buildings is bad and the ground rises above the
/// roof within it. Returns how many were not marked before. `plan` is the one `mesh` was made with;
/// `bad` has one entry per triangle; `marks.roofs` has its size.
std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan,
                               std::span<const std::uint8_t> bad, CutMarks& marks);

/// For every bad triangle outside buildings: marks as a foot, where its ground is, the lowest
/// vertex, if the triangle is steeper than `slope` (tangent); and, 15 degrees below the roof as
/// seen from the other end of their longest edge in it, its vertices on walls whose ground is
/// higher. Returns how often that was not marked before, or is lower now. `plan` is the one `mesh`
/// was made with; `bad` has one entry per triangle; `marks.feet` has its size.
std::int64_t mark_feet(const ColumnMesh& mesh, const ColumnPlan& plan,
                       std::span<const std::uint8_t> bad, double slope, CutMarks& marks);

/// How many cells have a dihedral angle outside the bounds.
std::int64_t count_bad_cells(const ColumnMesh& mesh, const AngleBounds& bounds);

}  // namespace tetropolis
