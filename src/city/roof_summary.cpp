#include "tetropolis/city/roof_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/units.h"

namespace tetropolis {

namespace {

/// Of what is below a plane and above `ground`: trapezoids below the edges towards a corner.
double volume_below(const Polygon& outline, const RoofPlane& roof, double ground) {
  const Point2 o = outline.outer[0];
  double sum = 0;
  for_each_edge(outline, [&](Point2 a, Point2 b) {
    const double twice = (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    sum += twice / 2 * ((roof(o) + roof(a) + roof(b)) / 3 - ground);
  });
  return sum;
}

double hundredths_of_degree(double radians) {
  return std::nearbyint(to_degrees(radians) * 100) / 100;
}

}  // namespace

double slope_degrees(const RoofPlane& plane) {
  return hundredths_of_degree(std::atan(std::hypot(plane.slope_x, plane.slope_y)));
}

std::optional<double> azimuth_degrees(const RoofPlane& plane) {
  if (plane.is_flat()) return std::nullopt;
  double azimuth = hundredths_of_degree(std::atan2(-plane.slope_x, -plane.slope_y));
  if (azimuth < 0) azimuth = hundredths_of_degree(to_radians(azimuth + 360));
  return azimuth < 360 ? azimuth + 0.0 : 0;
}

Lod highest_lod(std::span<const RoofPart> parts) {
  Lod lod = Lod::kBlock;
  for (const RoofPart& part : parts) lod = std::max(lod, part.lod);
  return lod;
}

double rmse_of(std::span<const RoofPart> parts) {
  double squares = 0, points = 0;
  for (const RoofPart& part : parts) {
    if (part.n_points == 0 || !std::isfinite(part.rmse)) continue;
    const auto n = static_cast<double>(part.n_points);
    squares += n * part.rmse * part.rmse;
    points += n;
  }
  return points > 0 ? std::sqrt(squares / points) : std::numeric_limits<double>::quiet_NaN();
}

double volume_of(const Building& building) {
  if (building.parts.empty())
    return area(building.footprint) * (building.h_roof - building.h_ground);
  double sum = 0;
  for (const RoofPart& part : building.parts)
    sum += volume_below(part.outline, part.roof, building.h_ground);
  return sum;
}

RoofRange range_of(const RoofPart& part) {
  RoofRange range{kInfinity, -kInfinity};
  for_each_edge(part.outline, [&](Point2 a, Point2) {
    const double z = part.roof(a);
    range = {std::min(range.low, z), std::max(range.high, z)};
  });
  return range;
}

double highest_roof(const Building& building) {
  if (building.parts.empty()) return building.h_roof;
  double highest = -kInfinity;
  for (const RoofPart& part : building.parts) highest = std::max(highest, range_of(part).high);
  return highest;
}

}  // namespace tetropolis
