// Local search for the cells that the division of columns leaves too thin.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/cell_quality.h"

namespace tetropolis {

/// What columns are improved for.
inline constexpr AngleBounds kGoodAngles{12, 157};

struct ImproveOptions {
  double least_deg = kGoodAngles.least;  ///< Cells with a smaller dihedral angle are worked on,
  double greatest_deg = kGoodAngles.greatest;  ///< and those with a greater one.
  double straight_deg = 90;  ///< And those on a face that is more non-orthogonal; 90: none are.
  int sweeps = 3;            ///< Over the columns of such cells, at most.
  /// Looked at by all sweeps; shared by them and their columns alike.
  std::int64_t most_cells = std::numeric_limits<std::int64_t>::max();
  /// Per triangle: the first sweep works on stacks over those that share a vertex with one that has
  /// 1 here, the others around what changed. Empty: on all.
  std::span<const std::uint8_t> near = {};
  std::span<const std::uint8_t> fixed = {};  ///< Per vertex, 1: the column stays. Empty: none does.
  /// Nodes that change do not become further apart, metres.
  double most_gap = std::numeric_limits<double>::infinity();
  /// Called once with the columns that change, ascending, when the mesh still is as it was.
  std::function<void(std::span<const VertexIndex> columns)> before_change = {};
};

struct Improvement {
  std::vector<VertexIndex> columns;  ///< Those that changed, ascending.
  std::int64_t cells = 0;            ///< Looked at, about; each as often as it was.
};

/// Moves, adds and removes nodes of the columns at bad cells wherever that makes the cells around
/// better, in at most `sweeps` passes with a few changes a column. As a column mesh is valid with
/// any numbers that rise, every trial is a valid mesh. Nodes at the ground, at roofs and at the top
/// stay, so the ground mesh, all surfaces and guarantees are untouched, and so is every column away
/// from bad cells.
///
/// How bad a cell is, is measured: with an angle t below the target T it costs
/// ((1 - cos T) / (1 - cos t))^2 - 1, about (T / t)^4 - 1, and likewise above the greatest angle;
/// of the faces, those between two cells over one triangle count, with (cos T / cos t)^2 - 1 (but
/// not the lowest face that a trial touches). Cells outside of kQualityFloor cost a hundred more,
/// so that nothing is gained at their price. A change is made if it lowers the sum over the cells
/// it touches. Columns that share no triangle do not touch the same cells and are worked on at the
/// same time.
///
/// Where very many cells are bad, a sweep takes only the two thousand worst stacks of each
/// connected place. With most_cells unlimited, columns therefore depend on connected bad stacks and
/// on what is around these, and on nothing else. Stacks over triangles with an angle below two
/// thirds of `least_deg` are left alone: some of their cells have that angle, too, whatever is
/// done. So are those over triangles too wide for `most_gap`, whose cells are as flat.
///
/// The same bits for any number of threads. Precondition: `mesh` is valid (require_valid). Throws
/// Cancelled.
Improvement improve_columns(ColumnMesh& mesh, const ImproveOptions& options = {},
                            const Progress& progress = {});

}  // namespace tetropolis
