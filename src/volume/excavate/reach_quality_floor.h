// From columns that are valid to columns above the floor of quality.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/step_clock.h"
#include "excavate.h"
#include "improve_place.h"
#include "volume/column/fill_columns.h"
#include "volume/quality/measured_mesh.h"

namespace tetropolis {

/// Cells that reports list.
inline constexpr std::size_t kWorstCells = 10;

struct ImprovedColumns {
  Columns columns;
  ExcavationSources excavated;
  std::int64_t columns_improved = 0;  ///< Whose nodes have moved.
  double min_vertical_gap = 0;        ///< As from require_valid.
  MeshQuality quality;                ///< Without what measure_ends() adds.
};

/// What runs the steps: run(id, name, body) calls body(progress) and times it.
using Steps = StepClock;

/// Moves nodes of columns where cells or faces are below the floor, and excavates terrain where
/// that is not enough: exact terrain comes first. Keeps only what makes a place better. Work is
/// bounded, so the floor may stay missed.
///
/// What is done at one place depends on the faults and columns around it (find_places) and on
/// nothing else. So each place has slopes of its own, work of its own, and its own share of thin
/// cells: of the cells in its part of the mesh (Cutout), fewer than kShareOfFew may be below
/// kLeastOfMost. These parts are disjoint and all thin cells lie in them. So where every place
/// keeps to its share, the mesh does.
///
/// Precondition: `columns` are valid (require_valid), graded, and over terrain not excavated yet.
/// The same bits for any number of threads. Throws Cancelled, and what `require_fits` does.
ImprovedColumns reach_quality_floor(Columns columns, const QualityFloorOptions& options,
                                    Steps& steps);

}  // namespace tetropolis
