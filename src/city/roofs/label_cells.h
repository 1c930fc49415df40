// Which roof plane each place of a building belongs to. Private to src/city.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "city/roofs/detect_planes.h"
#include "city/roofs/roof_cells.h"
#include "city/roofs/roof_input.h"

namespace tetropolis {

struct LabelOptions {
  Lod lod = Lod::k2_2;
  double percentile = 70;      ///< Of the points of a flat roof.
  double fallback_height = 0;  ///< Of members with fewer than four points, elevation.
  double min_area = 2;         ///< Square metres: no region is smaller, unless its member is.
  double step = 1;             ///< Metres: LoD1.3 tells heights that differ by that apart.
  double border_cost = 0.2;    ///< Square metres per metre of border.
  double cap = 1;              ///< Metres: points further off all count alike.
  double join_cost = 0.05;  ///< m^3: squared misfit times area that joining regions may cost, per
                            ///< metre of border that it takes away.
};

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

/// What the cells of a member chose.
struct MemberPlanes {
  std::vector<RoofPlane> planes;      ///< Empty: there are none.
  std::vector<std::int32_t> of_cell;  ///< Which of them, per cell of the member.
};

/// Per member: cells choose among its planes so that the sum of all points' distances (capped, over
/// the density) and of the borders' lengths is small: alpha expansion (Boykov, Veksler, Zabih,
/// "Fast approximate energy minimization via graph cuts", 2001). `detected`: per member.
std::vector<MemberPlanes> choose_planes(const RoofInput& input, const RoofCells& cells,
                                        std::span<const std::vector<DetectedPlane>> detected,
                                        const LabelOptions& options);

/// LoD1.2: one region per member and connected piece. LoD2.2: one per connected piece of a plane's
/// cells, of which those are joined that cost little. LoD1.3: what of these regions differs by less
/// than a step is one. A member whose points are more than 5 % further from these roofs than from
/// one flat roof (root mean squares) has that one. `chosen`: per member, by choose_planes().
RoofRegions label_cells(const RoofInput& input, const RoofCells& cells,
                        std::span<const MemberPlanes> chosen, const LabelOptions& options);

}  // namespace tetropolis
