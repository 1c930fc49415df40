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
#include "core/parallel.h"
#include "geometry/geos.h"

namespace tetropolis {

namespace {

/// Share of a footprint that planned buildings cover when it makes way.
constexpr double kReplaced = 0.5;

/// Square metres that outlines drawn along one wall have in common.
constexpr double kNoOverlap = 0.01;

/// What the plan leaves of a footprint; `by`: which planned building takes of it, if any does.
struct Rest {
  std::vector<Polygon> parts;
  const std::string* by = nullptr;
};

/// The planned buildings among others, which stay as they are meanwhile.
class Plan {
 public:
  explicit Plan(const std::vector<Building>& buildings) : buildings_(buildings) {
    for (std::size_t b = 0; b < buildings.size(); ++b) {
      if (!is_planned(buildings[b])) continue;
      planned_.push_back(b);
      boxes_.push_back(bounds(buildings[b].footprint));
      box_.extend(boxes_.back());
    }
  }

  /// Of a planned building the higher ones take their share, a tower of its podium; of any other
  /// all do. Where GEOS gives up, nothing is taken.
  Rest left_of(std::size_t b) const {
    Rest rest{{buildings_[b].footprint}};
    const Bounds2 box = bounds(buildings_[b].footprint);
    std::vector<std::size_t> takers;
    std::vector<Polygon> taken;
    for (std::size_t i = 0; i < planned_.size() && box.intersects(box_); ++i)
      if (box.intersects(boxes_[i]) && goes_before(planned_[i], b)) {
        takers.push_back(planned_[i]);
        taken.push_back(buildings_[planned_[i]].footprint);
      }
    if (takers.empty()) return rest;
    auto left = geos::subtract(rest.parts, taken, kCoordinateStep);
    if (!left || !(total_area(rest.parts) - total_area(*left) > kNoOverlap)) return rest;
    for (const std::size_t taker : takers) {
      const auto common =
          geos::intersect(rest.parts, std::array{buildings_[taker].footprint}, kCoordinateStep);
      if (!common || !(total_area(*common) > kNoOverlap)) continue;
      rest.by = &buildings_[taker].source_ids.front();
      break;
    }
    if (rest.by == nullptr) rest.by = &buildings_[takers.front()].source_ids.front();
    rest.parts = std::move(*left);
    return rest;
  }

 private:
  bool goes_before(std::size_t planned, std::size_t b) const {
    if (!is_planned(buildings_[b])) return true;
    const double own = buildings_[b].attribute_height;
    const double other = buildings_[planned].attribute_height;
    return other > own || (other == own && planned < b);
  }

  const std::vector<Building>& buildings_;
  std::vector<std::size_t> planned_;
  std::vector<Bounds2> boxes_;
  Bounds2 box_ = Bounds2::nothing();
};

}  // namespace

void make_way_for_planned(double min_area,
                          const std::function<std::string(const std::string&)>& part_id,
                          CleanFeatures& clean, std::vector<Warning>& warnings) {
  if (std::none_of(clean.buildings.begin(), clean.buildings.end(), is_planned)) return;
  const std::vector<Building> before = std::exchange(clean.buildings, {});
  const std::vector<std::uint32_t> basis = std::exchange(clean.basis, {});
  const Plan plan(before);
  std::vector<Rest> rests(before.size());
  parallel_chunks(before.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) rests[b] = plan.left_of(b);
  });
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
    const bool belongs = is_planned(building);
    if (belongs && !(building.attribute_height > 0)) {
      ++cleared;
      drop(building, "nothing is planned to stand there");
      continue;
    }
    planned += belongs ? 1 : 0;
    Rest& rest = rests[b];
    if (rest.by == nullptr) {
      keep(b, building);
      continue;
    }
    const double least = belongs ? 0 : (1 - kReplaced) * area(building.footprint);
    if (total_area(rest.parts) > least)
      rest.parts = clean_parts(std::move(rest.parts), min_area);
    else
      rest.parts.clear();
    if (!belongs) ++(rest.parts.empty() ? replaced : cut);
    if (rest.parts.empty()) drop(building, fmt::format("makes way for {}", *rest.by));
    clean.parts += std::max<std::int64_t>(std::ssize(rest.parts) - 1, 0);
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
