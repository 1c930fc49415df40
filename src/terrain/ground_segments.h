// Segments of cells, objects or terrain, judged as a whole by their rims and surroundings. Private
// to src/terrain.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/progress.h"

#include "cells.h"
#include "morphology.h"

namespace tetropolis {

/// Takes back from the objects what rises gradually: a bank, dyke or hilltop that is narrower than
/// the window, or steeper than the slope. An object ends in walls (Sithole & Vosselman, "Filtering
/// of airborne laser scanner data based on segmented point clouds", ISPRS Archives 36(3/W19), 2005,
/// tell the two apart by the rims of segments). Segments are object cells joined by steps that a
/// slope has; of the steps from a segment down, at most one in ten may be one that only a wall has
/// (and no slope that goes on behind it), and it has to rise by more than two of the others within:
/// a hedge or a terrace does not. `lowest`: NaN where there is no point.
void restore_gentle_rises(const HeightGrid& lowest, const Frame& frame,
                          std::vector<std::uint8_t>& object, const Progress& progress);

/// Makes objects of fragments: what openings left of podiums and halls that are in no footprint but
/// between them, where the voids of the footprints hold them up. A fragment is cells joined by
/// steps that a slope has, cut off by objects, footprints and walls, and a metre above most of the
/// ground nearby, after that ground's slope. All are judged before any goes. `barred`: 1 for cells
/// in footprints.
void reject_fragments(const HeightGrid& lowest, std::vector<std::uint8_t> barred,
                      const Frame& frame, std::vector<std::uint8_t>& object,
                      const Progress& progress);

}  // namespace tetropolis
