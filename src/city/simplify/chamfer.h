// Sharp corners of outlines are cut or filled where their walls are close to each other.
#pragma once

#include <cstdint>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

#include "city/outline.h"

namespace tetropolis {

/// Lengths in steps, areas in square steps, angles in radians.
struct ChamferOptions {
  double epsilon = 0;      ///< Width that an end of a corner gets; features stay so far apart.
  Domain keep_inside;      ///< New vertices stay in it.
  double least_angle = 0;  ///< Corners sharper than this are chamfered.
  double most_beyond = 0;  ///< Area that may go besides what is narrower than epsilon.
};

/// Whether a corner of the polygon, inside or outside, is sharper than `least_angle`.
bool has_sharp_corner(const Polygon& polygon, double least_angle);

/// Clearance says nothing of the two walls of a corner, and no mesh has a larger least angle than
/// the corner between them. So a corner sharper than least_angle loses its tip, as far as it is
/// narrower than epsilon (a wedge between walls is filled, the end of a needle is cut): its vertex
/// is replaced by two, or by an end of its walls where that is nearer than epsilon. Where that
/// would bring features closer than epsilon that were not, make edges touch, take more than half of
/// its ring's area, or leave as many sharp corners as there were, all of a needle that is hardly
/// wider than epsilon goes instead, or else the tip gets a width of epsilon, or else it is cut off
/// (or filled) further, by up to most_beyond; and where none of that can be done, the corner is
/// left as it is. Returns how many were chamfered: each call ends, and a call that returns 0 has
/// changed nothing. Precondition: no two edges cross.
std::int64_t chamfer_corners(Outline& outline, const ChamferOptions& options);

}  // namespace tetropolis
