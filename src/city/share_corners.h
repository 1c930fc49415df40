// Polygons that nearly meet are made to. Private to the library.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The polygons with corners within `tolerance` (metres) of each other made one (the first of
/// them), and with each other's corners that are within it of an edge as vertices of that; outer
/// rings counter-clockwise, holes clockwise. Holes that vanish are left out. Nothing if a polygon
/// vanishes, or there are more than 10,000 corners. Only additions, multiplications, divisions and
/// square roots: the same bits on every platform.
std::optional<std::vector<Polygon>> share_corners(std::span<const Polygon> polygons,
                                                  double tolerance);

/// What polygons that share their corners cover together, oriented likewise, each ring from its
/// lowest, then leftmost vertex; nothing where they overlap, touch in a point, or are in pieces.
std::optional<Polygon> common_outline(std::span<const Polygon> polygons);

}  // namespace tetropolis
