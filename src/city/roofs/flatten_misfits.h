// One flat roof for footprints that planes fit worse. Private to src/city.
#pragma once

#include "city/roofs/finish_parts.h"
#include "city/roofs/partition.h"
#include "city/roofs/region_points.h"

namespace tetropolis {

/// Regions of members that have a misfit become flat (LoD1.2), and one where they meet: lines
/// between them go, others stay where they are. `roof`: by finish_parts() from these lines and
/// points. Returns whether a region was not flat.
bool flatten_misfits(const FinishedRoof& roof, Partition& lines, RegionPoints& points);

}  // namespace tetropolis
