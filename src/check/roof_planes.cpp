#include "roof_planes.h"

#include <algorithm>
#include <cmath>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"

namespace tetropolis {

namespace {

/// z = elevation + slope . (p - at), written out anew.
double height_of(const RoofPlane& plane, Point2 p) {
  return plane.elevation + plane.slope_x * (p.x - plane.at.x) + plane.slope_y * (p.y - plane.at.y);
}

}  // namespace

RoofPlanes::RoofPlanes(const CityModel& city) {
  double greatest = 0;
  for (const Building& building : city.buildings) {
    first_.push_back(pieces_.size());
    if (building.parts.empty())
      pieces_.push_back(
          {&building.footprint, nullptr, building.h_roof, bounds(building.footprint)});
    for (const RoofPart& part : building.parts)
      pieces_.push_back({&part.outline, &part.roof, 0, bounds(part.outline)});
    for (const Point2 p : building.footprint.outer)
      greatest = std::max({greatest, std::abs(p.x + city.origin.x), std::abs(p.y + city.origin.y)});
  }
  first_.push_back(pieces_.size());
  rounding_ = std::nextafter(greatest, kInfinity) - greatest;
}

std::optional<std::size_t> RoofPlanes::part_at(BuildingIndex b, Point2 p) const {
  constexpr double kOnLine = 1e-3;  // metres
  std::optional<std::size_t> nearest;
  // Which part of one there is, is no question.
  if (parts(b) == 1) return 0;
  double least = kOnLine;
  for (std::size_t part = 0; part < parts(b); ++part) {
    const Piece& candidate = piece(b, part);
    if (!candidate.box.grown(kOnLine).contains(p)) continue;
    if (contains(*candidate.outline, p)) return part;
    const double away = distance_to_boundary(*candidate.outline, p);
    if (!(away < least)) continue;
    least = away;
    nearest = part;
  }
  return nearest;
}

const Polygon& RoofPlanes::outline(BuildingIndex b, std::size_t part) const {
  return *piece(b, part).outline;
}

double RoofPlanes::height(BuildingIndex b, std::size_t part, Point2 p) const {
  const Piece& at = piece(b, part);
  return at.plane == nullptr ? at.level : height_of(*at.plane, p);
}

double RoofPlanes::tolerance(BuildingIndex b, std::size_t part) const {
  constexpr double kHeightTolerance = 1e-9;  // metres
  const RoofPlane* plane = piece(b, part).plane;
  if (plane == nullptr) return kHeightTolerance;
  return kHeightTolerance + 2 * rounding_ * std::hypot(plane->slope_x, plane->slope_y);
}

std::pair<double, double> RoofPlanes::range_at(BuildingIndex b, Point2 p) const {
  // Vertices on lines are on the grid of coordinates, or where doubles have them.
  constexpr double kTouches = kCoordinateStep;
  std::pair range{kInfinity, -kInfinity};
  for (std::size_t part = 0; part < parts(b); ++part) {
    const Piece& candidate = piece(b, part);
    if (!candidate.box.grown(kTouches).contains(p)) continue;
    if (!contains(*candidate.outline, p) &&
        !(distance_to_boundary(*candidate.outline, p) <= kTouches))
      continue;
    const double z = height(b, part, p);
    range = {std::min(range.first, z), std::max(range.second, z)};
  }
  return range;
}

}  // namespace tetropolis
