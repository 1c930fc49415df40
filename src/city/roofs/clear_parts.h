// Parts of buildings that come from elsewhere, with room for cells between their lines. Private to
// src.
#pragma once

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Simplifies the lines of a building's parts to the clearance (clear_lines.h), so that as little
/// of its roof as can be changes: parts smaller than 2 m2 go to neighbours, and roofs steeper than
/// 70 degrees get these, about their middle. Vertices within a centimetre of a straight piece of
/// the outline leave it, where no line ends there. Parts keep source ids, levels and, up to
/// rounding and what has to give way, planes; a part that several become is the largest of them.
///
/// Returns whether part_defects finds nothing in the result; otherwise, as where the outline itself
/// does not keep the clearance, nothing is changed.
/// Precondition: the parts tile the footprint (tiling_fault). `clearance`: metres, > 0.
bool clear_parts(Building& building, double clearance);

}  // namespace tetropolis
