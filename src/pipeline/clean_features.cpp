#include "clean_features.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/clean.h"
#include "tetropolis/geometry/polygon.h"

#include "city/clip.h"
#include "core/parallel.h"
#include "core/shared_progress.h"
#include "default_domain.h"
#include "planned.h"

namespace tetropolis {

namespace {

/// Square metres of parts given up that are more than the slivers of a repair.
constexpr double kNoSliver = 1;

/// Ids for the parts that the domain and planned buildings cut features into, beyond the first:
/// those that follow the parts that a multipolygon has.
class PartIds {
 public:
  explicit PartIds(const FootprintsInput& input) {
    for (const Footprint& feature : input.features) taken_.insert(feature.source_id);
    for (const Dropped& feature : input.dropped) taken_.insert(feature.source_id);
  }
  std::string next(const std::string& source_id) {
    const std::size_t mark = source_id.rfind('#');
    const std::string whole = source_id.substr(0, mark);
    const std::string& base = taken_.contains(whole) ? whole : source_id;
    int& k = last_.try_emplace(base, 1).first->second;
    for (;;)
      if (std::string id = fmt::format("{}#{}", base, ++k); taken_.insert(id).second) return id;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;
};

/// Counts a feature of which parts have been given up, and names the first.
void count_lost_parts(const std::string& source_id, double lost_area, Warning& warning) {
  if (!(lost_area > kNoSliver) || warning.count++ > 0) return;
  warning.message = fmt::format(
      "where a footprint falls into parts as its rings are repaired, only the largest is kept, and "
      "where the domain cuts it, only those of min_building_area; the first is feature {}, which "
      "loses parts of {:.0f} m2",
      source_id, lost_area);
}

/// `ids`: of the buildings that are so.
void warn_of_open_below(std::span<const std::string> ids, std::vector<Warning>& warnings) {
  constexpr std::size_t kNamed = 3;
  if (ids.empty()) return;
  warnings.push_back(
      {"open_below", std::ssize(ids),
       fmt::format("{} buildings are roofs on posts or begin above the ground (building=roof, "
                   "min_height, building:min_level) and become blocks down to it ({}{}); leave "
                   "them out with `where` if air is to flow below them",
                   ids.size(), fmt::join(ids.first(std::min(kNamed, ids.size())), ", "),
                   ids.size() > kNamed ? ", ..." : "")});
}

/// Those outside the domain stay as they are made: nothing looks at them again.
std::vector<CleanedFootprint> clean_all(const BuildCityOptions& options,
                                        const FootprintsInput& input, const Domain& domain,
                                        const Progress& progress) {
  const std::size_t size = input.features.size();
  std::vector<CleanedFootprint> clean(size);
  SharedProgress shared(progress, static_cast<std::int64_t>(size));
  parallel_chunks(size, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Polygon& polygon = input.features[i].polygon;
      if (domain.position_of(polygon) != DomainPosition::kOutside)
        clean[i] = clean_footprint(polygon, {options.simplify.parallel_tolerance});
    }
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  return clean;
}

/// What is left of a feature, or why nothing is.
struct Kept {
  std::vector<Polygon> parts;
  std::uint32_t flags = 0;
  std::string reason;  ///< Empty where there are parts.
  DropCause cause = DropCause::kUnusable;
};

Kept outside() { return {{}, 0, kOutsideReason, DropCause::kOutside}; }
Kept at_boundary(const char* reason) { return {{}, 0, reason, DropCause::kBoundary}; }

/// `cleaned.lost_area` grows by what the boundary cuts off and is left out.
/// An area to be cleared counts as far as the domain goes.
Kept keep_inside(const BuildCityOptions& options, const Footprint& feature, const Domain& domain,
                 const std::optional<Bounds2>& covered, const std::optional<Domain>& outline,
                 CleanedFootprint& cleaned, std::vector<Polygon>& crossing) {
  if (domain.position_of(feature.polygon) == DomainPosition::kOutside) return outside();
  if (!cleaned.usable()) return {{}, 0, cleaned.reason};
  if (outline) {
    const DomainPosition position = outline->position_of(cleaned.polygon);
    if (position == DomainPosition::kOutside) return outside();
    if (position == DomainPosition::kCrossing && !feature.is_cleared())
      return at_boundary("crosses the domain boundary");
  }
  const std::uint32_t flags = cleaned.repaired ? kRepaired : 0U;
  const bool is_dropped =
      options.boundary_buildings == BoundaryBuildings::kDrop && !feature.is_cleared();
  // Of what is left: a spike without width may have reached across the boundary.
  switch (domain.position_of(cleaned.polygon)) {
    case DomainPosition::kOutside:
      return outside();
    case DomainPosition::kInside:
      if (!is_dropped || !covered || is_mostly_within(cleaned.polygon, *covered))
        return {{std::move(cleaned.polygon)}, flags, {}};
      crossing.push_back(std::move(cleaned.polygon));
      return at_boundary("lies mostly beyond the points");
    case DomainPosition::kCrossing:
      break;
  }
  // The box of what lies around a corner of the domain crosses it, too.
  std::vector<Polygon> inside = parts_in_domain(cleaned.polygon, domain);
  if (inside.empty()) return outside();
  if (is_dropped) {
    for (Polygon& part : inside) crossing.push_back(std::move(part));
    return at_boundary("crosses the domain boundary");
  }
  // Cut back by the merge distance, so that the strip left is wide enough to mesh.
  const Domain room = domain.inset(options.simplify.min_distance + kCoordinateStep * 4);
  double cut_off = 0;
  std::vector<Polygon> parts =
      clip_to_domain(cleaned.polygon, room, options.simplify.min_area, &cut_off);
  if (parts.empty()) return at_boundary("crosses the domain boundary, with nothing left inside");
  cleaned.lost_area += cut_off;
  return {std::move(parts), flags | kClipped, {}};
}

}  // namespace

CleanFeatures clean_features(const BuildCityOptions& options, const FootprintsInput& input,
                             const Domain& domain, const std::optional<Bounds2>& covered,
                             const std::optional<Domain>& outline, std::vector<Warning>& warnings,
                             const Progress& progress) {
  std::vector<CleanedFootprint> clean = clean_all(options, input, domain, progress);
  CleanFeatures result;
  result.dropped.assign(input.dropped.begin(), input.dropped.end());
  Warning lost_parts{"parts_lost", 0, {}};
  std::vector<std::string> open_below;
  PartIds part_ids(input);
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const Footprint& feature = input.features[i];
    Kept kept = keep_inside(options, feature, domain, covered, outline, clean[i], result.crossing);
    if (kept.parts.empty()) {
      result.dropped.push_back({feature.source_id, std::move(kept.reason), kept.cause});
      continue;
    }
    if (feature.is_open_below) open_below.push_back(feature.source_id);
    count_lost_parts(feature.source_id, clean[i].lost_area, lost_parts);
    result.parts += static_cast<std::int64_t>(kept.parts.size()) - 1;
    for (std::size_t k = 0; k < kept.parts.size(); ++k) {
      Building building;
      building.flags = kept.flags | (feature.is_planned ? kPlanned : 0U);
      building.id = fmt::format("b{}", result.buildings.size());
      building.source_ids = {k == 0 ? feature.source_id : part_ids.next(feature.source_id)};
      building.footprint = std::move(kept.parts[k]);
      building.attribute_height = snap_height(feature.height);
      building.attribute_roof = feature.base + feature.height;
      result.basis.push_back(feature.from_floors ? kRoofFromFloors : kRoofFromAttribute);
      result.buildings.push_back(std::move(building));
    }
  }
  make_way_for_planned(
      options.simplify.min_area, [&](const std::string& id) { return part_ids.next(id); }, result,
      warnings);
  for (const Building& building : result.buildings) result.area += area(building.footprint);
  for (const Polygon& part : result.crossing)
    result.area_lost += covered ? total_area(parts_in_domain(part, *covered)) : area(part);
  result.area += result.area_lost;
  if (lost_parts.count > 0) warnings.push_back(lost_parts);
  warn_of_open_below(open_below, warnings);
  return result;
}

}  // namespace tetropolis
