#include "vector_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "io/crs/gdal_support.h"
#include "io/deferred/gdal_functions.h"
#include "io/vector/quirks/turned_rings.h"

namespace tetropolis {

namespace {

// Collections inside collections inside ...: nobody draws footprints this deep.
constexpr int kDeepest = 32;

bool read_ring(OGRGeometryH ring, Ring& result) {
  const int count = OGR_G_GetPointCount(ring);
  result.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const Point2 p{OGR_G_GetX(ring, i), OGR_G_GetY(ring, i)};
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return false;
    result.push_back(p);
  }
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return true;
}

/// In metres, eastings first. Where an elevation is none, all of the face are not a number.
Face read_face(OGRGeometryH polygon, const PlanUnits& units) {
  constexpr double kHighest = 1e6;  // metres
  Face face;
  bool has_elevations = true;
  for (int r = 0; r < OGR_G_GetGeometryCount(polygon); ++r) {
    OGRGeometryH ring = OGR_G_GetGeometryRef(polygon, r);
    std::vector<Point3>& points = face.rings.emplace_back();
    for (int i = 0; i < OGR_G_GetPointCount(ring); ++i) {
      Point3 p{units.metres_per_unit * OGR_G_GetX(ring, i),
               units.metres_per_unit * OGR_G_GetY(ring, i),
               units.metres_per_height * OGR_G_GetZ(ring, i)};
      if (units.north_first) std::swap(p[0], p[1]);
      has_elevations = has_elevations && std::abs(p[2]) <= kHighest;
      points.push_back(p);
    }
  }
  if (!has_elevations)
    for (std::vector<Point3>& ring : face.rings)
      for (Point3& p : ring) p[2] = std::numeric_limits<double>::quiet_NaN();
  return face;
}

/// Puts faces without elevations at the bottom of the others.
void settle_elevations(std::vector<Face>& faces) {
  double low = kInfinity;
  const auto for_each_point = [&](const auto& visit) {
    for (Face& face : faces)
      for (std::vector<Point3>& ring : face.rings)
        for (Point3& p : ring) visit(p);
  };
  for_each_point([&](const Point3& p) { low = std::fmin(low, p[2]); });
  for_each_point([&](Point3& p) {
    if (std::isnan(p[2])) p[2] = std::isfinite(low) ? low : 0;
  });
}

PolygonPart read_polygon(OGRGeometryH polygon) {
  PolygonPart part;
  const int rings = OGR_G_GetGeometryCount(polygon);
  if (rings == 0 || OGR_G_IsEmpty(polygon) != 0) {
    part.reason = "an empty polygon";
    return part;
  }
  for (int r = 0; r < rings; ++r) {
    Ring ring;
    if (!read_ring(OGR_G_GetGeometryRef(polygon, r), ring)) {
      part.reason = "coordinates that are not finite";
      return part;
    }
    if (r == 0)
      part.polygon.outer = std::move(ring);
    else if (ring.size() >= 3)
      part.polygon.holes.push_back(std::move(ring));
  }
  if (part.polygon.outer.size() < 3) part.reason = "a polygon of fewer than three vertices";
  return part;
}

bool holds_others(OGRwkbGeometryType type) {
  return type == wkbMultiPolygon || type == wkbGeometryCollection || type == wkbPolyhedralSurface ||
         type == wkbTIN;
}

/// Calls visit(polygon) for the polygons of a geometry in their order, and other() for what is
/// none, or nested too deep.
template <typename Visit, typename Other>
void for_each_polygon(OGRGeometryH geometry, int depth, const Visit& visit, const Other& other) {
  const OGRwkbGeometryType type = wkbFlatten(OGR_G_GetGeometryType(geometry));
  if (type == wkbPolygon || type == wkbTriangle)
    visit(geometry);
  else if (holds_others(type) && depth < kDeepest)
    for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i)
      for_each_polygon(OGR_G_GetGeometryRef(geometry, i), depth + 1, visit, other);
  else
    other();
}

/// Whether some of the geometry is a surface in space, by its type.
bool holds_surface(OGRGeometryH geometry, int depth) {
  const OGRwkbGeometryType type = wkbFlatten(OGR_G_GetGeometryType(geometry));
  if (type == wkbPolyhedralSurface || type == wkbTIN) return true;
  if (type != wkbGeometryCollection || depth >= kDeepest) return false;
  for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i)
    if (holds_surface(OGR_G_GetGeometryRef(geometry, i), depth + 1)) return true;
  return false;
}

/// Whether the faces are those of a body: several of them are walls, and not just a few of many,
/// such as slivers or bow-ties among the footprints of a city.
bool are_of_body(const std::vector<Face>& faces) {
  constexpr std::size_t kLeastWalls = 3, kFacesPerWall = 10;
  const auto walls = static_cast<std::size_t>(std::count_if(faces.begin(), faces.end(), is_wall));
  return walls >= kLeastWalls && walls * kFacesPerWall >= faces.size();
}

/// Puts the footprint of a body in the place of its faces, in the units and the order of
/// coordinates of its geometry; parts that are no faces stay, with their reason. False, and only
/// the reason changes, if there is none.
bool take_footprint(const std::vector<Face>& faces, const PlanUnits& units, FlatGeometry& result) {
  // Of an upright triangle two vertices may be all there is in the plan.
  const auto is_sound = [&](std::size_t i) {
    return result.parts[i].reason.empty() || is_wall(faces[i]);
  };
  std::vector<Face> sound;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (is_sound(i)) sound.push_back(faces[i]);
  FootprintResult footprint = footprint_of(sound);
  result.reason = std::move(footprint.reason);
  if (footprint.polygons.empty()) return false;
  std::vector<PolygonPart> parts;
  for (Polygon& polygon : footprint.polygons) {
    for_each_vertex(polygon, [&](Point2& p) {
      p = {p.x / units.metres_per_unit, p.y / units.metres_per_unit};
      if (units.north_first) std::swap(p.x, p.y);
    });
    parts.push_back({std::move(polygon), {}});
  }
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (!is_sound(i)) parts.push_back(std::move(result.parts[i]));
  result.parts = std::move(parts);
  return true;
}

std::string reason_without_polygons(OGRwkbGeometryType type) {
  switch (wkbFlatten(type)) {
    case wkbPoint:
    case wkbMultiPoint:
      return "a point, not a polygon";
    case wkbLineString:
    case wkbMultiLineString:
      return "a line, not a polygon";
    default:
      return "no polygon in the geometry";
  }
}

/// Whether a layer of this geometry type may hold polygons.
bool may_hold_polygons(OGRwkbGeometryType type) {
  switch (wkbFlatten(type)) {
    case wkbUnknown:
    case wkbPolygon:
    case wkbMultiPolygon:
    case wkbCurvePolygon:
    case wkbMultiSurface:
    case wkbSurface:
    case wkbTriangle:
    case wkbPolyhedralSurface:
    case wkbTIN:
    case wkbGeometryCollection:
      return true;
    default:
      return false;
  }
}

}  // namespace

namespace {

/// Closed lines are outlines, as drawings have them; nothing if one is open.
std::vector<PolygonPart> outlines_of_lines(OGRGeometryH geometry) {
  const OGRwkbGeometryType type = wkbFlatten(OGR_G_GetGeometryType(geometry));
  std::vector<PolygonPart> parts;
  if (type == wkbMultiLineString) {
    for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i) {
      std::vector<PolygonPart> one = outlines_of_lines(OGR_G_GetGeometryRef(geometry, i));
      if (one.empty()) return {};
      parts.push_back(std::move(one.front()));
    }
    return parts;
  }
  constexpr int kLeast = 4;
  const int count = type == wkbLineString ? OGR_G_GetPointCount(geometry) : 0;
  if (count < kLeast || OGR_G_GetX(geometry, 0) != OGR_G_GetX(geometry, count - 1) ||
      OGR_G_GetY(geometry, 0) != OGR_G_GetY(geometry, count - 1))
    return {};
  PolygonPart part;
  if (!read_ring(geometry, part.polygon.outer) || part.polygon.outer.size() < 3) return {};
  parts.push_back(std::move(part));
  return parts;
}

}  // namespace

FlatGeometry flatten(OGRGeometryH geometry, const PlanUnits& units) {
  FlatGeometry result;
  if (geometry == nullptr) {
    result.reason = "no geometry";
    return result;
  }
  if (OGR_G_IsEmpty(geometry) != 0) {
    result.reason = "an empty geometry";
    return result;
  }
  gdal::Geometry linear;
  if (OGR_G_HasCurveGeometry(geometry, FALSE) != 0) {
    linear.reset(OGR_G_GetLinearGeometry(geometry, 0, nullptr));
    geometry = linear.get();
    if (geometry == nullptr) {
      result.reason = "a curve that cannot be straightened";
      return result;
    }
  }
  bool has_elevations = false;
  for_each_polygon(
      geometry, 0,
      [&](OGRGeometryH polygon) {
        result.parts.push_back(read_polygon(polygon));
        has_elevations = has_elevations || OGR_G_Is3D(polygon) != 0;
      },
      [&] { ++result.other_parts; });
  if (result.parts.empty()) {
    result.parts = outlines_of_lines(geometry);
    result.is_of_lines = !result.parts.empty();
    if (result.is_of_lines) result.other_parts = 0;
  }
  const bool is_surface = holds_surface(geometry, 0);
  std::vector<Face> faces;  // of each part, if it matters
  if (is_surface || (has_elevations && result.parts.size() > 1))
    for_each_polygon(
        geometry, 0, [&](OGRGeometryH polygon) { faces.push_back(read_face(polygon, units)); },
        [] {});
  settle_elevations(faces);
  if (is_surface || are_of_body(faces)) {
    result.is_body = take_footprint(faces, units, result);
    if (result.is_body) return result;
    if (is_surface) {
      result.parts.clear();
      return result;
    }
    result.reason.clear();
  }
  result.courtyards = take_courtyards_for_holes(result.parts, faces, units.metres_per_unit);
  if (result.parts.empty())
    result.reason = reason_without_polygons(OGR_G_GetGeometryType(geometry));
  return result;
}

namespace {

/// Whether one of the first features has polygons there.
bool finds_polygons(OGRLayerH layer, int field) {
  constexpr int kProbed = 1000;
  bool found = false;
  OGR_L_ResetReading(layer);
  for (int i = 0; i < kProbed && !found; ++i) {
    const gdal::Feature feature(OGR_L_GetNextFeature(layer));
    if (feature == nullptr) break;
    found = !flatten(OGR_F_GetGeomFieldRef(feature.get(), field)).parts.empty();
  }
  OGR_L_ResetReading(layer);
  return found;
}

}  // namespace

int polygon_field(OGRLayerH layer) {
  OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
  const int fields = OGR_FD_GetGeomFieldCount(definition);
  int declared = -1;
  for (int field = fields - 1; field >= 0; --field) {
    const OGRwkbGeometryType type = OGR_GFld_GetType(OGR_FD_GetGeomFieldDefn(definition, field));
    const OGRwkbGeometryType flat = wkbFlatten(type);
    if (may_hold_polygons(type) && flat != wkbUnknown && flat != wkbGeometryCollection)
      declared = field;
  }
  // Of several fields GDAL may declare one as what another is.
  if (declared >= 0 && fields == 1) return declared;
  for (int field = 0; field < fields; ++field)
    if (may_hold_polygons(OGR_GFld_GetType(OGR_FD_GetGeomFieldDefn(definition, field))) &&
        finds_polygons(layer, field))
      return field;
  return declared;
}

}  // namespace tetropolis
