#include "tetropolis/pipeline/meshable.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/part_lines.h"
#include "city/part_tiling.h"
#include "city/roofs/clear_parts.h"
#include "core/units.h"
#include "elevations.h"
#include "require_room.h"

namespace tetropolis {

namespace {

constexpr auto kMeshWhatIsMade =
    "mesh the city.city.json that 'tetropolis city' makes, or, in a program, the city that "
    "build_city makes of read_footprints";

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
      return kOutsideReason;
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

/// Why a mesh cannot have the parts as they are; empty if it can.
std::string reason_to_flatten(const std::vector<RoofPart>& parts, double min_distance) {
  // Lines that made 13.5 degrees have been snapped to the grid of coordinates.
  constexpr double kLeastAngleDeg = 13, kSteepestDeg = 70;
  const LineClearance lines = line_clearance(parts);
  if (!is_clear(lines.distance, min_distance))
    return fmt::format("roof lines come as close as {:.4f} m ({} m required)", lines.distance,
                       min_distance);
  if (lines.angle < to_radians(kLeastAngleDeg))
    return fmt::format("roof lines meet at {:.1f} degrees", to_degrees(lines.angle));
  for (const RoofPart& part : parts)
    if (const double slope = std::atan(std::hypot(part.roof.slope_x, part.roof.slope_y));
        slope > to_radians(kSteepestDeg))
      return fmt::format("a roof has {:.1f} degrees", to_degrees(slope));
  return {};
}

/// Why parts are not what a mesh stands on; empty if they are.
std::string fault_of_parts(const Building& building, double min_distance) {
  if (building.parts.empty()) return {};
  if (const std::string fault = tiling_fault(building.footprint, building.parts); !fault.empty())
    return "its parts " + fault;
  for (const RoofPart& part : building.parts)
    if (const double low = range_of(part).low; !(low > building.h_ground))
      return fmt::format("a roof goes down to {:.3f} m, and h_ground is {:.3f} m", low,
                         building.h_ground);
  const double distance = line_clearance(building.parts).distance;
  if (!is_clear(distance, min_distance))
    return fmt::format("its roof lines come as close as {:.4f} m ({} m required)", distance,
                       min_distance);
  return {};
}

}  // namespace

FlattenedRoofs flatten_unmeshable(CityModel& city, double min_distance) {
  FlattenedRoofs flattened;
  for (Building& building : city.buildings) {
    if (building.parts.empty()) continue;
    std::string reason = reason_to_flatten(building.parts, min_distance);
    if (reason.empty()) continue;
    if (Building simpler = building; clear_parts(simpler, min_distance)) {
      const std::string left = reason_to_flatten(simpler.parts, min_distance);
      if (left.empty()) {
        building = std::move(simpler);
        if (flattened.simplified++ == 0)
          flattened.first_simplified = name_of(building) + ": " + reason;
        continue;
      }
      reason = left;
    }
    if (flattened.count++ == 0) flattened.first = name_of(building) + ": " + reason;
    building.parts.clear();
    building.footprint = without_junctions(building.footprint);
  }
  return flattened;
}

std::size_t drop_unmeshable(CityModel& city, double min_distance) {
  const std::size_t before = city.dropped.size();
  std::erase_if(city.buildings, [&](const Building& building) {
    const std::string reason = reason_to_leave_out(building, city.domain, min_distance);
    if (reason.empty()) return false;
    const bool is_outside = city.domain.position_of(building.footprint) == DomainPosition::kOutside;
    for (const std::string& id : building.source_ids)
      city.dropped.push_back({id, reason, is_outside ? DropCause::kOutside : DropCause::kBoundary});
    return true;
  });
  return city.dropped.size() - before;
}

double require_meshable(const CityModel& city, double min_distance, const std::string& source) {
  std::vector<Polygon> footprints;
  for (const Building& building : city.buildings) footprints.push_back(building.footprint);
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::kInput, fmt::format("{}: {}; {}, or lower min_building_distance", source,
                                               what, kMeshWhatIsMade));
  };
  for (const Building& building : city.buildings)
    if (const std::string reason = reason_to_leave_out(building, city.domain, min_distance);
        !reason.empty())
      fail(fmt::format("{}: {}; the domain is {}", name_of(building), reason, domain_text(city)));
  const auto defects = footprint_defects(footprints, 1);
  if (!defects.empty()) {
    const auto first = static_cast<std::size_t>(std::max(defects.front().first.polygon, 0));
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {}: {}; {}", source, name_of(city.buildings[first]),
                            defects.front().message, kMeshWhatIsMade));
  }
  for (const Building& building : city.buildings)
    if (const std::string fault = fault_of_parts(building, min_distance); !fault.empty())
      fail(fmt::format("{}: {}", name_of(building), fault));
  const Clearance clearance = joint_clearance(footprints, city.domain);
  if (!is_clear(clearance.distance, min_distance))
    fail(fmt::format(
        "footprints come as close as {:.4f} m ({} m required) at {}", clearance.distance,
        min_distance,
        name_of(city.buildings[static_cast<std::size_t>(std::max(clearance.vertex.polygon, 0))])));
  return clearance.distance;
}

}  // namespace tetropolis
