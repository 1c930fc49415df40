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

#include <ogr_core.h>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "geometry/perimeter.h"
#include "io/crs/gdal_support.h"

namespace tetropolis {

namespace {

// Collections inside collections inside ...: nobody draws footprints this deep.
constexpr int kDeepest = 32;

struct GeometryDeleter {
  void operator()(OGRGeometryH geometry) const { OGR_G_DestroyGeometry(geometry); }
};
using Geometry = std::unique_ptr<std::remove_pointer_t<OGRGeometryH>, GeometryDeleter>;

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

/// Whether all vertices of `inner` are in `outer`, whose outline is larger, and not in its holes.
bool encloses(const Polygon& outer, const Ring& inner) {
  if (!(std::abs(signed_area(outer.outer)) > std::abs(signed_area(inner)))) return false;
  return bounds(outer).contains(inner.front()) &&
         std::all_of(inner.begin(), inner.end(), [&](Point2 p) { return contains(outer, p); });
}

/// A hole that encloses its shell becomes the shell, if `turns` is so of the two.
template <typename Turns>
void put_widest_ring_first(Polygon& polygon, const Turns& turns) {
  for (Ring& hole : polygon.holes)
    if (turns(polygon.outer, hole) && encloses({hole, {}}, polygon.outer))
      std::swap(hole, polygon.outer);
}

/// Whether all of `inner` lies within `outer`, and no hole of that within it. A part that fills a
/// hole to its rim does not: vertices on the rim may count as inside, its middle does not.
bool encloses(const Polygon& outer, const Polygon& inner) {
  const Polygon covered{inner.outer, {}};
  return encloses(outer, inner.outer) && contains(outer, interior_point(covered)) &&
         std::none_of(outer.holes.begin(), outer.holes.end(), [&](const Ring& hole) {
           return contains(covered, interior_point({hole, {}}));
         });
}

bool turns_left(const PolygonPart& part) { return signed_area(part.polygon.outer) > 0; }

/// Calls visit(j, candidates) for the usable parts from west to east; all parts whose box reaches
/// that of j are among the candidates. A city may be one multipolygon: each part is compared with
/// its neighbours only.
template <typename Visit>
void sweep(const std::vector<Bounds2>& boxes, const Visit& visit) {
  const auto west = [&](std::size_t i) { return boxes[i].xmin; };
  std::vector<std::size_t> order;
  for (std::size_t j = 0; j < boxes.size(); ++j)
    if (!boxes[j].empty()) order.push_back(j);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return west(i) < west(j); });
  std::vector<std::size_t> begun;
  std::size_t next = 0, most_begun = 64;
  for (const std::size_t j : order) {
    for (; next < order.size() && west(order[next]) <= west(j); ++next)
      begun.push_back(order[next]);
    if (begun.size() > most_begun) {
      std::erase_if(begun, [&](std::size_t i) { return boxes[i].xmax < west(j); });
      most_begun = std::max<std::size_t>(64, 2 * begun.size());
    }
    visit(j, begun);
  }
}

enum class Turns { kTell, kSayNothing };

/// For each part the one that it is a yard of, or parts.size(): the smallest that encloses it, if
/// that is turned against it, as far as turns tell, and the part is not itself in a yard of that.
std::vector<std::size_t> find_yards(const std::vector<PolygonPart>& parts, Turns turns) {
  std::vector<Bounds2> boxes;
  for (const PolygonPart& part : parts)
    boxes.push_back(part.reason.empty() ? bounds(part.polygon.outer) : Bounds2::nothing());
  const std::size_t none = parts.size();
  std::vector<std::size_t> yard_of(parts.size(), none);
  sweep(boxes, [&](std::size_t j, const std::vector<std::size_t>& candidates) {
    std::size_t depth = 0;
    std::pair least{kInfinity, none};
    for (const std::size_t i : candidates) {
      if (!boxes[i].covers(boxes[j]) || !encloses(parts[i].polygon, parts[j].polygon)) continue;
      ++depth;
      least = std::min(least, {std::abs(signed_area(parts[i].polygon.outer)), i});
    }
    const std::size_t around = least.second;
    if (depth % 2 == 0) return;
    if (turns == Turns::kSayNothing || turns_left(parts[around]) != turns_left(parts[j]))
      yard_of[j] = around;
  });
  // Parts that overlap may make a yard of a yard, which nobody would find again: it stays a part.
  const std::vector<std::size_t> found = yard_of;
  for (std::size_t& around : yard_of)
    if (around != none && found[around] != none) around = none;
  return yard_of;
}

/// Makes holes of the yards, and parts of what stands in them, which was a hole in the yard.
/// Returns how many yards there are.
std::int64_t cut_out_yards(std::vector<PolygonPart>& parts,
                           const std::vector<std::size_t>& yard_of) {
  const std::size_t none = parts.size();
  std::vector<PolygonPart> in_yards;
  for (std::size_t j = 0; j < yard_of.size(); ++j) {
    if (yard_of[j] == none) continue;
    for (Ring& ring : parts[j].polygon.holes) in_yards.push_back({{std::move(ring), {}}, {}});
    parts[yard_of[j]].polygon.holes.push_back(std::move(parts[j].polygon.outer));
  }
  std::size_t j = 0;
  const std::size_t yards =
      std::erase_if(parts, [&](const PolygonPart&) { return yard_of[j++] != none; });
  std::move(in_yards.begin(), in_yards.end(), std::back_inserter(parts));
  return static_cast<std::int64_t>(yards);
}

/// Whether two faces lie above each other: then one is a roof.
bool lie_apart(const Face& a, const Face& b) {
  constexpr double kApart = 1;  // metres
  const auto [low_a, high_a] = elevations(a);
  const auto [low_b, high_b] = elevations(b);
  return low_a > high_b + kApart || low_b > high_a + kApart;
}

/// Mean width of what is left of a ring less one within it.
double width_between(const Ring& outer, const Ring& inner) {
  return 2 * (std::abs(signed_area(outer)) - std::abs(signed_area(inner))) /
         perimeter(Polygon{outer, {inner}});
}

/// Several yards are polygons of their own for GDAL then: parts within a part, turned against it.
/// They become holes again; parts that turn alike stay parts, whatever they overlap. So do the roof
/// and the ground of a building, of which one looks down. `faces`: of the parts, or none. Returns
/// how many yards there are.
std::int64_t take_yards_for_holes(std::vector<PolygonPart>& parts, const std::vector<Face>& faces,
                                  const PlanUnits& units) {
  constexpr double kLeastWing = 1;  // metres; eaves are less wide
  const auto alike = [&](const PolygonPart& part) {
    return turns_left(part) == turns_left(parts.front());
  };
  if (parts.size() < 2 || std::all_of(parts.begin(), parts.end(), alike)) return 0;
  std::vector<std::size_t> yard_of = find_yards(parts, Turns::kTell);
  for (std::size_t j = 0; j < yard_of.size(); ++j) {
    const std::size_t around = yard_of[j];
    if (around == parts.size()) continue;
    const double width =
        units.metres_per_unit * width_between(parts[around].polygon.outer, parts[j].polygon.outer);
    if (width < kLeastWing || (!faces.empty() && lie_apart(faces[around], faces[j])))
      yard_of[j] = parts.size();
  }
  return cut_out_yards(parts, yard_of);
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
  Geometry linear;
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
  result.yards = take_yards_for_holes(result.parts, faces, units);
  if (result.parts.empty())
    result.reason = reason_without_polygons(OGR_G_GetGeometryType(geometry));
  return result;
}

void mend_order_of_rings(FlatGeometry& geometry) {
  const auto as_hole_and_shell = [](const Ring& first, const Ring& other) {
    return signed_area(first) < 0 && signed_area(other) > 0;
  };
  for (PolygonPart& part : geometry.parts)
    if (part.reason.empty()) put_widest_ring_first(part.polygon, as_hole_and_shell);
}

void mend_turned_rings(FlatGeometry& geometry) {
  const auto any = [](const Ring&, const Ring&) { return true; };
  for (PolygonPart& part : geometry.parts)
    if (part.reason.empty()) put_widest_ring_first(part.polygon, any);
  // All holes, by their turn: some are, and those lie within others.
  if (geometry.parts.size() > 1 &&
      std::all_of(geometry.parts.begin(), geometry.parts.end(), turns_left))
    cut_out_yards(geometry.parts, find_yards(geometry.parts, Turns::kSayNothing));
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
