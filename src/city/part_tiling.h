// Whether parts are what RoofPart says they are. Private to the library.
#pragma once

#include <span>
#include <string>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// What keeps the outlines from tiling the footprint edge by edge (a clause such as "do not meet at
/// 12.5, 3"); empty if nothing: every outline is valid, with the outer ring counter-clockwise and
/// holes clockwise, and each of its edges is one of another outline the other way round, or one of
/// the footprint's, all of which are used. Precondition: a valid footprint, oriented likewise.
std::string tiling_fault(const Polygon& footprint, std::span<const RoofPart> parts);

}  // namespace tetropolis
