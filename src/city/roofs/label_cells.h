// Which region of the roof each place of a building belongs to. Private to src/city.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "city/roofs/choose_planes.h"
#include "city/roofs/roof_cells.h"
#include "city/roofs/roof_input.h"

namespace tetropolis {

/// What became a region, and its roof.
struct RegionRoof {
  RoofPlane plane;
  MemberNumber member = 0;
  Lod lod = Lod::k2_2;  ///< kBlock: the height is options.fallback_height.
};

struct RoofRegions {
  std::vector<RoofRegion> of_cell;  ///< Connected regions, each within one member's cells.
  std::vector<RegionRoof> roofs;    ///< Per region.
};

/// LoD1.2: one region per member and connected piece. LoD2.2: one per connected piece of a plane's
/// cells, of which those are joined that cost little. LoD1.3: what of these regions differs by less
/// than a metre is one. A member whose points are more than 5 % further from these roofs than from
/// one flat roof (root mean squares) has that one. `chosen`: per member, by choose_planes().
RoofRegions label_cells(const RoofInput& input, const RoofCells& cells,
                        std::span<const MemberPlanes> chosen, const LabelOptions& options);

}  // namespace tetropolis
