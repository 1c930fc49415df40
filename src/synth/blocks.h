// Buildings on the blocks of the synthetic block city.
#pragma once

#include <vector>

#include "scan.h"
#include "seeded_random.h"
#include "street_plan.h"

namespace tetropolis {

struct PlotOptions {
  double scale = 1;                 ///< Of the plots' frontages: wider plots give fewer buildings.
  bool around_a_courtyard = false;  ///< One building with a hole instead of a perimeter block.
};

/// Appends the buildings of one block. Vertices are whole millimetres; adjoining buildings share
/// every vertex of their party wall. Buildings stay within the block.
void build_on_block(const Block& block, const PlotOptions& options, SeededRandom& random,
                    std::vector<SyntheticBuilding>& buildings);

/// Whether a perimeter block is large enough for a courtyard.
bool has_room_for_courtyard(const Block& block);

}  // namespace tetropolis
