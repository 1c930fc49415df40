// Areas of the ground, whose lines are cleared as those of roofs are.
#pragma once

#include <span>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/surfaces.h"

namespace tetropolis {

/// Divides the ground by areas and simplifies their lines together, so that no end of one is nearer
/// than `clearance` to another end, or to a line it does not belong to, buildings and sides
/// included, and no two lines meet at less than 30 degrees: but for what outlines do among
/// themselves, whose corners stay where they are. Areas smaller than ten squares of the clearance
/// go to what is around them. Lines shared by two areas stay shared.
///
/// `areas`: local frame, metres; `footprints`: as a city's, clean and inside the domain, with
/// clearance. Coordinates of lines at corners of footprints and of the domain are those, bit for
/// bit. Throws Error(kInput) where the lines cannot be brought together.
Surfaces divide_ground(std::span<const SurfaceArea> areas, std::span<const Polygon> footprints,
                       const Domain& domain, double clearance);

}  // namespace tetropolis
