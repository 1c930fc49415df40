#include "tetropolis/pipeline/meshable.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/clip.h"
#include "elevations.h"
#include "require_room.h"

namespace tetropolis {

namespace {

std::string name_of(const Building& building) {
  return fmt::format("building {} (feature {})", building.id,
                     building.source_ids.empty() ? "?" : building.source_ids.front());
}

/// Why there can be no mesh around a building by itself; empty if there can.
std::string reason_to_leave_out(const Building& building, const Domain& domain, double distance) {
  for (const double height : {building.h_ground, building.h_roof})
    if (!is_elevation(height))
      return fmt::format("reaches from {:.6g} to {:.6g} m, which are no elevations",
                         building.h_ground, building.h_roof);
  switch (domain.position_of(building.footprint)) {
    case DomainPosition::kOutside:
      return "outside the domain";
    case DomainPosition::kCrossing:
      return "crosses the domain boundary";
    case DomainPosition::kInside:
      break;
  }
  // As cities are made: what is that close to the boundary leaves no room for cells.
  for (const Point2 p : building.footprint.outer)
    if (!is_clear(domain.distance_to_boundary(p), distance))
      return "closer than min_building_distance to the domain boundary";
  return {};
}

}  // namespace

std::size_t drop_unmeshable(CityModel& city, double min_distance) {
  const std::size_t before = city.dropped.size();
  std::erase_if(city.buildings, [&](const Building& building) {
    const std::string reason = reason_to_leave_out(building, city.domain, min_distance);
    if (reason.empty()) return false;
    for (const std::string& id : building.source_ids)
      city.dropped.push_back({id, reason, DropCause::kBoundary});
    return true;
  });
  return city.dropped.size() - before;
}

double require_meshable(const CityModel& city, double min_distance, const std::string& source) {
  std::vector<Polygon> footprints;
  for (const Building& building : city.buildings) footprints.push_back(building.footprint);
  const auto fail = [&](const std::string& what) {
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: {}; mesh the city.city.json that 'tetropolis city' makes, or lower "
                    "min_building_distance",
                    source, what));
  };
  for (const Building& building : city.buildings)
    if (const std::string reason = reason_to_leave_out(building, city.domain, min_distance);
        !reason.empty())
      fail(fmt::format("{}: {}; the domain is {}", name_of(building), reason, domain_text(city)));
  const auto defects = footprint_defects(footprints, 1);
  if (!defects.empty()) {
    const auto first = static_cast<std::size_t>(std::max(defects.front().first.polygon, 0));
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {}: {}; mesh the city.city.json that 'tetropolis city' makes",
                            source, name_of(city.buildings[first]), defects.front().message));
  }
  const Clearance clearance = joint_clearance(footprints, city.domain);
  if (!is_clear(clearance.distance, min_distance))
    fail(fmt::format(
        "footprints come as close as {:.4f} m ({} m required) at {}", clearance.distance,
        min_distance,
        name_of(city.buildings[static_cast<std::size_t>(std::max(clearance.vertex.polygon, 0))])));
  return clearance.distance;
}

}  // namespace tetropolis
