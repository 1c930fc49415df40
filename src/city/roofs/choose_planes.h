// Which of the planes found in it each place of a footprint belongs to. Private to src/city.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "city/roofs/detect_planes.h"
#include "city/roofs/roof_cells.h"
#include "city/roofs/roof_input.h"

namespace tetropolis {

/// Of choose_planes() and label_cells().
struct LabelOptions {
  Lod lod = Lod::k2_2;
  double percentile = 70;      ///< Of the points of a flat roof.
  double fallback_height = 0;  ///< Of members with fewer than four points, elevation.
  double min_area = 2;         ///< Square metres: no region is smaller, unless its member is.
};

inline constexpr double kBorderCost = 0.2;  ///< Square metres per metre of border.
inline constexpr double kPointCap = 1;      ///< Metres: points further off all count alike.

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

}  // namespace tetropolis
