#include "body_parts.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"

#include "city/part_tiling.h"
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
  const std::vector<Point3>& outer = face.rings[0];
  const Point2 at{outer[0][0], outer[0][1]};
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  for (const std::vector<Point3>& ring : face.rings)
    for (const Point3& p : ring) {
      const double u = p[0] - at.x, v = p[1] - at.y, w = p[2] - outer[0][2];
      n += 1;
      x += u;
      y += v;
      z += w;
      xx += u * u;
      xy += u * v;
      yy += v * v;
      xz += u * w;
      yz += v * w;
    }
  const double a = xx - x * x / n, b = xy - x * y / n, c = yy - y * y / n;
  const double d = xz - x * z / n, e = yz - y * z / n;
  const double determinant = a * c - b * b;
  if (!(determinant > 1e-9 * a * c)) return std::nullopt;
  RoofPlane plane;
  plane.at = at;
  plane.slope_x = (d * c - e * b) / determinant;
  plane.slope_y = (a * e - b * d) / determinant;
  plane.elevation = outer[0][2] + (z - plane.slope_x * x - plane.slope_y * y) / n;
  if (!(std::hypot(plane.slope_x, plane.slope_y) <= kSteepest)) return std::nullopt;
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

}  // namespace tetropolis
