// From the lid over a city to the flat top of its domain, with fewer and fewer columns.
#pragma once

#include <cstddef>

#include "tetropolis/core/progress.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "front.h"

namespace tetropolis {

/// Cells from the tops of columns to the elevation `top`. A front climbs: the column whose next
/// segment has the lowest midpoint goes first, and either rises, which leaves a tet over every
/// triangle around it, as in the columns below; or ends, where its neighbours are higher: then the
/// hole is covered by triangles between these, and under each of them lies a tet. So the longer
/// the way to the lid, the fewer columns are left, and their segments are as long as their
/// triangles are wide. Columns at the rim of the domain, and beside it, go on to the top.
/// Nodes and cells are numbered by column and upwards.
///
/// Cells keep to kGoodAngles and to kMostNonOrthogonal wherever there is a way to; a column ends
/// only where they do. What happens at a place depends on its surroundings only. Takes time N log
/// N, and while it runs 15 bytes per cell besides the result; the same bits on every machine, for
/// any number of threads and of tiles that these are given (front.h; 0: as are useful).
/// Precondition: `mesh` is valid and has no upper part; its columns end below `top` or at it.
/// Throws Cancelled.
UpperMesh grow_upper(const ColumnMesh& mesh, double top, const Progress& progress = {},
                     std::size_t tiles = 0);

/// What columns have done, as a mesh over that of these.
UpperMesh upper_of(FrontPhases phases, const ColumnMesh& mesh);

}  // namespace tetropolis
