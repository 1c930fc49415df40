// The body of a building of several roofs. Private to src/io.
#pragma once

#include <cstddef>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

enum class SolidFaceKind { kGround, kRoof, kOuterWall, kStep };

/// A planar face that looks outwards. Inner rings are turned the other way.
struct SolidFace {
  SolidFaceKind kind = SolidFaceKind::kGround;
  std::size_t part = 0;  ///< Whose roof it is, or whose wall: of a step, the higher one's.
  std::vector<std::vector<Point3>> rings;
  /// Of a roof: positions, counted through its rings, of vertices that the outline does not have:
  /// there the roofs on either side of a line cross.
  std::vector<std::size_t> crossings;
};

/// The faces of the body between the ground and the roofs of the parts: the ground, a roof per
/// part (the outline's vertices, in its order), walls.
///
/// Faces share edges whole: a wall has every corner of a roof that is on its vertical edges, and
/// where two roofs cross along a common line they and the walls have a vertex, 2 mm or more from
/// the line's ends. Every edge is in two faces, once in each direction, but for vertical edges
/// around which roofs are high, low, high and low again: these are in four.
///
/// Elevations of roofs are in whole millimetres; those of one corner that are less than a
/// millimetre apart are one. Roofs are off their planes by 2 mm of climb and 1 mm at most.
///
/// Precondition: parts as RoofPart states; roofs above h_ground.
std::vector<SolidFace> roof_solid(const Building& building);

}  // namespace tetropolis
