// One place with cells below the floor of quality.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "tetropolis/core/progress.h"

#include "excavate.h"
#include "places.h"
#include "volume/column/fill_columns.h"

namespace tetropolis {

struct QualityFloorOptions {
  ColumnPlanOptions plan;    ///< That the columns were planned with.
  double gentlest_deg = 56;  ///< Terrain is excavated to slopes of 75, 66 or, where neither
                             ///< is enough, so many degrees; 90: nowhere.
  double most_gap = std::numeric_limits<double>::infinity();  ///< As in ImproveOptions.
  std::int64_t work = 200'000'000;  ///< Cells that the searches at one place, for one slope, may
                                    ///< look at; a cell takes some 70 ns.
  /// Throws if so many cells are too many. May be empty.
  std::function<void(double cells)> require_fits;
};

/// What becomes of a place.
struct PlaceOutcome {
  ColumnPlan plan;
  ColumnMesh mesh;                  ///< Without ground mesh and edges in copies.
  std::vector<std::uint8_t> moved;  ///< Per vertex, 1: its nodes have moved.
  ExcavationSources sources;
};

/// Moves nodes of the place's columns, and excavates terrain where that is not enough, as steeply
/// as leaves the place above the floor. Nothing if more has to be excavated than fits into the
/// cutout.
///
/// `moved`: per vertex of the cutout, 1 if its nodes have moved before. `cells_elsewhere`: of the
/// mesh without the cutout, for `options.require_fits`. `progress` is asked whether to go on.
/// Throws Cancelled, and what `require_fits` does.
std::optional<PlaceOutcome> improve_place(Cutout cutout, std::vector<std::uint8_t> moved,
                                          const QualityFloorOptions& options,
                                          double cells_elsewhere, const Progress& progress);

}  // namespace tetropolis
