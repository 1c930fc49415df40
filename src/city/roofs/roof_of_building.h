// The roof of one building, from its points to its parts. Private to src/city.
#pragma once

#include <vector>

#include "tetropolis/city/roofs.h"

#include "city/roofs/finish_parts.h"
#include "city/roofs/label_cells.h"
#include "city/roofs/roof_cells.h"
#include "city/roofs/roof_input.h"

namespace tetropolis {

/// What the points of a building tell, at any LoD.
struct RoofFindings {
  RoofCells cells;
  std::vector<MemberPlanes> planes;  ///< Per member.
};
RoofFindings find_planes(const RoofInput& input, const RoofOptions& options);

/// `found`: by find_planes(), with these options or others whose LoD is not LoD1.2.
/// `fallback_height`, `lowest`: elevations of roofs without points, and that no roof goes below.
FinishedRoof roof_of_building(const RoofInput& input, const RoofFindings& found,
                              const RoofOptions& options, double fallback_height, double lowest);

}  // namespace tetropolis
