// From labelled cells to straight lines. Private to src/city.
#pragma once

#include "city/roofs/label_cells.h"
#include "city/roofs/partition.h"
#include "city/roofs/roof_cells.h"

namespace tetropolis {

/// The borders of regions as a planar partition: chains of cells' edges simplified (Douglas,
/// Peucker, "Algorithms for the reduction of the number of points required to represent a digitized
/// line", 1973), each piece on the line of least squares or on the planes' intersection, bends and
/// junctions moved to where their lines meet. Corners of the footprint keep their coordinates;
/// other nodes of the outline are on it, up to rounding. `reach`: as far as later steps look
/// around, metres.
Partition trace_lines(const Polygon& footprint, const RoofCells& cells, const RoofRegions& regions,
                      double reach);

}  // namespace tetropolis
