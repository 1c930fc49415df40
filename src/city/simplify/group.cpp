#include "group.h"

#include <utility>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"

#include "assign_members.h"
#include "city/grid_geometry.h"
#include "core/parallel.h"
#include "overlay.h"

namespace tetropolis {

std::optional<Polygon> largest_of(const std::vector<Polygon>& polygons) {
  if (polygons.empty()) return std::nullopt;
  return largest(polygons);
}

bool GroupInput::is_inside(const Polygon& polygon) const { return keep_inside_.covers(polygon); }

/// What is left of a footprint far enough inside the domain; empty if that is less than half of it.
Polygon GroupInput::usable_part(const Polygon& polygon) const {
  if (is_inside(polygon)) return polygon;
  std::optional<Polygon> part;
  if (!keep_inside_.empty()) part = largest_of(inside(polygon));
  if (!part || !is_inside(*part) || area(*part) < 0.5 * area(polygon)) return {};
  return std::move(*part);
}

std::vector<Group> GroupInput::single_groups() const {
  std::vector<Group> groups(cleaned_.size());
  parallel_chunks(groups.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Group& group = groups[i];
      group.members = {BuildingIndex(i)};
      group.polygon = grid::to_steps(cleaned_[i]);
      if (group.polygon.outer.size() < 3) group.polygon = {};
      group.input = {group.polygon};
      if (is_inside(group.polygon)) continue;
      group.flags = kClipped;
      Polygon part = usable_part(group.polygon);
      // What is cut off is no loss, nor what is outside of one that is dropped.
      if (!part.outer.empty())
        group.input = {part};
      else
        group.input = keep_inside_.empty() ? std::vector<Polygon>() : inside(group.polygon);
      group.polygon = std::move(part);
    }
  });
  return groups;
}

std::vector<Polygon> GroupInput::inside(const Polygon& polygon) const {
  return intersect_on_grid(std::vector{polygon}, std::vector{keep_inside_.outline()});
}

std::vector<Polygon> GroupInput::input_of(const std::vector<BuildingIndex>& members) const {
  std::vector<Polygon> input;
  for (const BuildingIndex m : members) input.push_back(usable_part(grid::to_steps(cleaned_[m])));
  return input.size() > 1 ? unite_or_largest(input) : input;
}

/// What follows from the members alone.
std::uint32_t GroupInput::flags_of(const std::vector<BuildingIndex>& members) const {
  std::uint32_t flags = 0;
  if (members.size() > 1) flags |= kMerged;
  for (const BuildingIndex m : members)
    if (!is_inside(grid::to_steps(cleaned_[m]))) flags |= kClipped;
  return flags;
}

/// Shares the input of a group out to it and the parts that have some of its members.
void GroupInput::share_input(Group& group, std::span<Group> parts) const {
  const auto take_off = [](Group& part, const std::vector<Polygon>& others) {
    const Bounds2 box = grid::box_around(part.input);
    std::vector<Polygon> near;
    for (const Polygon& other : others)
      if (bounds(other).intersects(box)) near.push_back(other);
    if (near.empty()) return;
    std::vector<Polygon> rest = subtract_on_grid(part.input, near);
    if (rest.empty()) return;
    part.input = std::move(rest);
    part.shares_input = true;
  };
  std::vector<Polygon> gone;
  for (Group& part : parts) {
    part.input = input_of(part.members);
    if (group.shares_input) {
      std::vector<Polygon> left = intersect_on_grid(group.input, part.input);
      if (!left.empty()) part.input = std::move(left);
    }
    part.shares_input = group.shares_input;
    take_off(part, gone);
    gone.insert(gone.end(), part.input.begin(), part.input.end());
  }
  group.shares_input = true;
  group.input = subtract_on_grid(group.input, gone);
  if (!group.input.empty()) return;
  group.input = input_of(group.members);
  for (Group& part : parts) take_off(part, group.input);
}

std::vector<Group> GroupInput::split(const std::vector<Polygon>& parts, double least_area,
                                     Group& group) const {
  if (parts.size() < 2 || group.members.size() < 2) return {};
  std::size_t kept = 0;
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (area(parts[i]) > area(parts[kept])) kept = i;
  std::vector<Group> groups;
  for (SplitPart& split : assign_members(parts, kept, least_area, cleaned_, group.members)) {
    Group& part = groups.emplace_back();
    part.flags = flags_of(split.members) | kRepaired | (group.flags & kConvexHull);
    part.polygon = std::move(split.polygon);
    if (!is_inside(part.polygon))
      part.polygon = largest_of(inside(part.polygon)).value_or(Polygon{});
    part.members = std::move(split.members);
  }
  if (groups.empty()) return groups;
  share_input(group, groups);
  group.flags = (group.flags & ~std::uint32_t{kMerged | kClipped}) | flags_of(group.members);
  return groups;
}

}  // namespace tetropolis
