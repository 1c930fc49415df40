#include "planned.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"

#include "city/clip.h"
#include "geometry/geos.h"

namespace tetropolis {

namespace {

/// Share of a footprint that planned buildings cover when it makes way.
constexpr double kReplaced = 0.5;

/// Square metres that outlines drawn along one wall have in common.
constexpr double kNoOverlap = 0.01;

bool is_planned(const Building& building) { return (building.flags & kPlanned) != 0; }

/// What stands there once the plan is built.
class Plan {
 public:
  explicit Plan(const std::vector<Building>& buildings) {
    for (const Building& building : buildings) {
      if (!is_planned(building)) continue;
      outlines_.push_back(building.footprint);
      boxes_.push_back(bounds(building.footprint));
      ids_.push_back(&building.source_ids.front());
      box_.extend(boxes_.back());
    }
  }

  /// The planned outlines that may meet the polygon.
  std::vector<std::size_t> near(const Polygon& polygon) const {
    std::vector<std::size_t> found;
    const Bounds2 box = bounds(polygon);
    for (std::size_t i = 0; i < boxes_.size() && box.intersects(box_); ++i)
      if (box.intersects(boxes_[i])) found.push_back(i);
    return found;
  }

  const Polygon& outline(std::size_t i) const { return outlines_[i]; }
  const std::string& id(std::size_t i) const { return *ids_[i]; }

 private:
  std::vector<Polygon> outlines_;
  std::vector<Bounds2> boxes_;
  std::vector<const std::string*> ids_;  ///< Of the buildings given, which stay as they are.
  Bounds2 box_ = Bounds2::nothing();
};

/// What the plan leaves of a footprint; `by`: which planned building takes most of it, if any does.
struct Rest {
  std::vector<Polygon> parts;
  const std::string* by = nullptr;
};

Rest left_of(const Polygon& footprint, const Plan& plan) {
  Rest rest{{footprint}};
  double most = kNoOverlap;
  for (const std::size_t i : plan.near(footprint)) {
    const double before = total_area(rest.parts);
    auto left = geos::subtract(rest.parts, std::array{plan.outline(i)}, kCoordinateStep);
    if (!left) left.emplace();  // GEOS gave up: what is planned goes first
    const double taken = before - total_area(*left);
    if (!(taken > kNoOverlap)) continue;
    rest.parts = std::move(*left);
    if (taken > most) {
      most = taken;
      rest.by = &plan.id(i);
    }
  }
  return rest;
}

}  // namespace

void make_way_for_planned(double min_area,
                          const std::function<std::string(const std::string&)>& part_id,
                          CleanFeatures& clean, std::vector<Warning>& warnings) {
  if (std::none_of(clean.buildings.begin(), clean.buildings.end(), is_planned)) return;
  const std::vector<Building> before = std::exchange(clean.buildings, {});
  const std::vector<std::uint32_t> basis = std::exchange(clean.basis, {});
  const Plan plan(before);
  const auto keep = [&](std::size_t b, Building building) {
    building.id = fmt::format("b{}", clean.buildings.size());
    clean.buildings.push_back(std::move(building));
    clean.basis.push_back(basis[b]);
  };
  const auto drop = [&](const Building& building, std::string reason) {
    clean.dropped.push_back({building.source_ids.front(), std::move(reason), DropCause::kReplaced});
  };
  std::int64_t planned = 0, cleared = 0, replaced = 0, cut = 0;
  for (std::size_t b = 0; b < before.size(); ++b) {
    const Building& building = before[b];
    if (is_planned(building)) {
      const bool stands = building.attribute_height > 0;
      ++(stands ? planned : cleared);
      if (stands)
        keep(b, building);
      else
        drop(building, "nothing is planned to stand there");
      continue;
    }
    Rest rest = left_of(building.footprint, plan);
    if (rest.by == nullptr) {
      keep(b, building);
      continue;
    }
    const double whole = area(building.footprint), left = total_area(rest.parts);
    if (left > (1 - kReplaced) * whole) rest.parts = clean_parts(std::move(rest.parts), min_area);
    if (!(left > (1 - kReplaced) * whole) || rest.parts.empty()) {
      ++replaced;
      drop(building, fmt::format("makes way for {}", *rest.by));
      continue;
    }
    ++cut;
    clean.parts += std::ssize(rest.parts) - 1;
    for (std::size_t k = 0; k < rest.parts.size(); ++k) {
      Building part = building;
      part.flags |= kClipped;
      part.footprint = std::move(rest.parts[k]);
      if (k > 0) part.source_ids = {part_id(building.source_ids.front())};
      keep(b, std::move(part));
    }
  }
  warnings.push_back(
      {"planned", planned + cleared,
       fmt::format("buildings: {}, areas to be cleared: {}; footprints that make way: {}, that are "
                   "cut: {}",
                   planned, cleared, replaced, cut)});
}

}  // namespace tetropolis
