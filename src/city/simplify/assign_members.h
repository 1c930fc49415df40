// Which buildings of a group belong to which part, once a cut has split it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A part that goes on by itself, and its members, ascending.
struct SplitPart {
  Polygon polygon;
  std::vector<BuildingIndex> members;
};

/// Assigns the members of a polygon to the parts that cutting has left of it: each belongs to
/// the part that it overlaps most, so that no building vanishes because it hung together with
/// another by a thin wall. `parts` are disjoint, in steps (grid_geometry.h); `kept` is the one that
/// goes on as the polygon; `cleaned` holds the footprints that members are indices of, metres.
/// Returns the others of at least `least` square steps that got members, in their order; `members`
/// loses theirs. Parts without members of their own are left out: a feature cannot be in two
/// buildings. If `kept` would lose all members, nothing is assigned.
std::vector<SplitPart> assign_members(const std::vector<Polygon>& parts, std::size_t kept,
                                      double least, std::span<const Polygon> cleaned,
                                      std::vector<BuildingIndex>& members);

}  // namespace tetropolis
