#include "body_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"

#include "city/part_tiling.h"
#include "city/roofs/plane_fit.h"
#include "city/share_corners.h"
#include "geometry/geos.h"
#include "geometry/perimeter.h"

namespace tetropolis {

namespace {

constexpr double kSame = 0.01;          // metres
constexpr double kMostOffPlane = 0.05;  // metres
constexpr double kSteepest = 100;       // tangent; what is more is a wall

/// The plane with the least squares of vertical distances from the vertices of a face; nothing if
/// that is vertical.
std::optional<RoofPlane> plane_of(const Face& face) {
  const Point3& first = face.rings[0][0];
  const Point2 at{first[0], first[1]};
  PlaneFit fit(at);
  for (const std::vector<Point3>& ring : face.rings)
    for (const Point3& p : ring) fit.add({p[0], p[1], p[2] - first[2]});
  constexpr double kLine = 1e-10;
  const std::optional<RoofPlane> fitted = fit.plane_unless_line(kLine);
  if (!fitted || !(slope_of(*fitted) <= kSteepest)) return std::nullopt;
  const RoofPlane plane{at, first[2] + (*fitted)(at), fitted->slope_x, fitted->slope_y};
  return snap_plane(plane);
}

bool is_on(const Face& face, const RoofPlane& plane) {
  for (const std::vector<Point3>& ring : face.rings)
    for (const Point3& p : ring)
      if (!(std::abs(plane({p[0], p[1]}) - p[2]) <= kMostOffPlane)) return false;
  return true;
}

Polygon plan_of(const Face& face) {
  Polygon plan;
  for (std::size_t r = 0; r < face.rings.size(); ++r) {
    Ring& ring = r == 0 ? plan.outer : plan.holes.emplace_back();
    for (const Point3& p : face.rings[r]) ring.push_back(snap_coordinate(Point2{p[0], p[1]}));
  }
  return plan;
}

bool have_same_plan(const Polygon& footprint, const Polygon& ground) {
  const std::span a(&footprint, 1), b(&ground, 1);
  if (!geos::is_valid(a)) return false;
  const geos::Result more = geos::subtract(a, b, 0), less = geos::subtract(b, a, 0);
  return more && less && total_area(*more) + total_area(*less) <= kSame * perimeter(ground);
}

BodyParts without(std::string reason) { return {{}, {}, std::move(reason)}; }

}  // namespace

BodyParts parts_of(std::span<const Face> faces, const Polygon& ground, double low, Lod lod) {
  BodyParts result;
  std::vector<Polygon> plans;
  for (const Face& face : faces) {
    if (!face.is_roof || face.rings.empty() || face.rings[0].size() < 3) continue;
    const std::optional<RoofPlane> plane = plane_of(face);
    if (!plane) return without("a vertical roof");
    if (!is_on(face, *plane)) return without("a roof that is not planar");
    plans.push_back(plan_of(face));
    RoofPart& part = result.parts.emplace_back();
    part.roof = *plane;
    part.lod = lod;
    part.rmse = std::numeric_limits<double>::quiet_NaN();
  }
  if (plans.empty()) return without("no RoofSurface");
  const std::optional<std::vector<Polygon>> shared = share_corners(plans, kSame);
  if (!shared) return without("a roof without area, or more than 10,000 corners");
  for (std::size_t k = 0; k < result.parts.size(); ++k) {
    result.parts[k].outline = (*shared)[k];
    if (!(range_of(result.parts[k]).low > low + kMostOffPlane))
      return without("a roof that is not above the ground");
  }
  std::optional<Polygon> footprint = common_outline(*shared);
  if (!footprint) return without("roofs that overlap, touch in a point or leave gaps");
  if (!have_same_plan(*footprint, ground))
    return without("roofs that stick out over the ground or do not cover it");
  result.footprint = std::move(*footprint);
  const std::string fault = tiling_fault(result.footprint, result.parts);
  if (!fault.empty()) return without("roofs that " + fault);
  if (result.parts.size() == 1 && result.parts[0].roof.is_flat()) return {};
  return result;
}

StatedRoof stated_roof(const Polygon& outline, const RoofPlane& plane, double ground) {
  StatedRoof roof{outline, {plane.at, plane.at, plane.at}, {}};
  roof.at[1].x += 1;
  roof.at[2].y += 1;
  for (std::size_t i = 0; i < roof.at.size(); ++i) roof.height[i] = plane(roof.at[i]) - ground;
  return roof;
}

std::vector<StatedRoof> stated_roofs(std::span<const Face> faces, double ground) {
  const auto is_roof = [](const Face& face) { return face.is_roof; };
  const bool are_known = std::any_of(faces.begin(), faces.end(), is_roof);
  std::vector<StatedRoof> roofs;
  for (const Face& face : faces) {
    if ((are_known && !face.is_roof) || face.rings.empty() || face.rings[0].size() < 3) continue;
    if (const std::optional<RoofPlane> plane = plane_of(face))
      roofs.push_back(stated_roof(plan_of(face), *plane, ground));
  }
  return roofs;
}

}  // namespace tetropolis
