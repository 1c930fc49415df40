// The buildings to be while footprints are simplified, and which of the input is whose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// One building to be. Coordinates in steps (grid_geometry.h).
struct Group {
  Polygon polygon;
  /// Union of its members, cut back from the domain's boundary, before anything else was changed.
  /// Not empty; groups' inputs are disjoint, unless one had nothing of its own (GroupInput::split).
  std::vector<Polygon> input;
  std::vector<BuildingIndex> members;  ///< Indices of footprints, ascending.
  std::uint32_t flags = 0;             ///< Of BuildingFlag.
  bool shares_input = false;           ///< Other groups have some of the union of its members.
  bool courtyards_filled = false;      ///< It was lost and had its courtyards filled.
};

/// The largest polygon (the first of equals), or none.
std::optional<Polygon> largest_of(const std::vector<Polygon>& polygons);

/// The footprints as far as they are inside the domain, and what groups have of them.
class GroupInput {
 public:
  /// `cleaned`: in metres; it outlives this. `keep_inside`: where groups may be, in steps.
  GroupInput(std::span<const Polygon> cleaned, const Domain& keep_inside)
      : cleaned_(cleaned), keep_inside_(keep_inside) {}

  /// A group of each footprint by itself, in their order. Its polygon is empty if the footprint has
  /// fewer than three distinct vertices or if less than half of it is left inside.
  std::vector<Group> single_groups() const;

  /// What of a polygon is inside.
  std::vector<Polygon> inside(const Polygon& polygon) const;

  /// Groups of their own from the parts that a cut has left of a group beside the largest, which
  /// stays `group`: those of at least `least_area` square steps that members belong to (see
  /// assign_members). Its input is shared out, too: where members overlap, the first part has what
  /// they have in common; but nobody goes without.
  std::vector<Group> split(const std::vector<Polygon>& parts, double least_area,
                           Group& group) const;

 private:
  bool is_inside(const Polygon& polygon) const;
  Polygon usable_part(const Polygon& polygon) const;
  std::vector<Polygon> input_of(const std::vector<BuildingIndex>& members) const;
  std::uint32_t flags_of(const std::vector<BuildingIndex>& members) const;
  void share_input(Group& group, std::span<Group> parts) const;

  std::span<const Polygon> cleaned_;
  Domain keep_inside_;  ///< Steps.
};

}  // namespace tetropolis
