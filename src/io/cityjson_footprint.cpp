#include "cityjson_footprint.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <geos_c.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"

namespace tetropolis {

namespace {

/// A GEOS context of its own for each call: no messages, no shared state.
class Geos {
 public:
  Geos() : context_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(context_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
  GEOSContextHandle_t get() const { return context_; }

 private:
  GEOSContextHandle_t context_;
};

struct GeometryDeleter {
  GEOSContextHandle_t context;
  void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(context, geometry); }
};
using Geometry = std::unique_ptr<GEOSGeometry, GeometryDeleter>;

Ring project(const std::vector<Point3>& ring) {
  Ring result;
  for (const Point3& p : ring) {
    const Point2 q = snap_coordinate(Point2{p[0], p[1]});
    if (result.empty() || !(result.back() == q)) result.push_back(q);
  }
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return result;
}

/// Vector area by Newell's formula (Sutherland, Sproull, Schumacker, 1974).
Point3 normal(const std::vector<Point3>& ring) {
  Point3 n{};
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Point3& a = ring[j];
    const Point3& b = ring[i];
    n[0] += (a[1] - b[1]) * (a[2] + b[2]) / 2;
    n[1] += (a[2] - b[2]) * (a[0] + b[0]) / 2;
    n[2] += (a[0] - b[0]) * (a[1] + b[1]) / 2;
  }
  return n;
}

/// Cosine of the angle to the vertical: 1 looks up, -1 down, 0 is a wall.
double uprightness(const Face& face) {
  if (face.rings.empty() || face.rings[0].size() < 3) return 0;
  const Point3 n = normal(face.rings[0]);
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return length > 0 ? n[2] / length : 0;
}

std::vector<Polygon> project_faces(const std::vector<const Face*>& faces) {
  std::vector<Polygon> polygons;
  for (const Face* face : faces) {
    Polygon polygon;
    for (std::size_t r = 0; r < face->rings.size(); ++r) {
      Ring ring = project(face->rings[r]);
      if (ring.size() < 3 || signed_area(ring) == 0) {
        if (r == 0) break;
        continue;
      }
      if (r == 0)
        polygon.outer = std::move(ring);
      else
        polygon.holes.push_back(std::move(ring));
    }
    if (!polygon.outer.empty()) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

std::vector<const Face*> select(const std::vector<Face>& faces, double low, double high,
                                bool only_ground) {
  std::vector<const Face*> chosen;
  for (const Face& face : faces) {
    if (only_ground && !face.is_ground) continue;
    const double up = uprightness(face);
    if (up >= low && up <= high) chosen.push_back(&face);
  }
  return chosen;
}

/// The faces whose shadow is the footprint.
std::vector<Polygon> ground_polygons(const std::vector<Face>& faces) {
  constexpr double kFlat = 0.5;  // Steeper than 60 degrees is no floor.
  constexpr double kNotWall = 0.01;
  std::vector<Polygon> polygons = project_faces(select(faces, -1, 1, true));
  if (polygons.empty()) polygons = project_faces(select(faces, -1, -kFlat, false));
  if (polygons.empty()) polygons = project_faces(select(faces, kNotWall, 1, false));
  if (polygons.empty()) polygons = project_faces(select(faces, -1, -kNotWall, false));
  return polygons;
}

GEOSGeometry* make_ring(const Geos& geos, const Ring& ring) {
  const auto size = static_cast<unsigned>(ring.size() + 1);
  GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(geos.get(), size, 2);
  for (unsigned i = 0; i < size; ++i) {
    const Point2& p = ring[i % ring.size()];
    GEOSCoordSeq_setXY_r(geos.get(), sequence, i, p.x, p.y);
  }
  return GEOSGeom_createLinearRing_r(geos.get(), sequence);
}

Geometry make_polygon(const Geos& geos, const Polygon& polygon) {
  std::vector<GEOSGeometry*> holes;
  for (const Ring& hole : polygon.holes) holes.push_back(make_ring(geos, hole));
  GEOSGeometry* made = GEOSGeom_createPolygon_r(geos.get(), make_ring(geos, polygon.outer),
                                                holes.data(), static_cast<unsigned>(holes.size()));
  Geometry geometry(made, {geos.get()});
  if (geometry != nullptr && GEOSisValid_r(geos.get(), made) != 1)
    geometry.reset(GEOSMakeValid_r(geos.get(), made));
  return geometry;
}

Ring read_ring(const Geos& geos, const GEOSGeometry* line) {
  const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(geos.get(), line);
  unsigned size = 0;
  GEOSCoordSeq_getSize_r(geos.get(), sequence, &size);
  std::vector<Point3> points(size);
  for (unsigned i = 0; i < size; ++i)
    GEOSCoordSeq_getXY_r(geos.get(), sequence, i, &points[i][0], &points[i][1]);
  return project(points);
}

void read_polygons(const Geos& geos, const GEOSGeometry* geometry, std::vector<Polygon>& result) {
  if (GEOSGeomTypeId_r(geos.get(), geometry) != GEOS_POLYGON) {
    const int parts = GEOSGetNumGeometries_r(geos.get(), geometry);
    if (GEOSGeomTypeId_r(geos.get(), geometry) < GEOS_MULTIPOINT) return;
    for (int i = 0; i < parts; ++i)
      read_polygons(geos, GEOSGetGeometryN_r(geos.get(), geometry, i), result);
    return;
  }
  if (GEOSisEmpty_r(geos.get(), geometry) != 0) return;
  Polygon polygon;
  polygon.outer = read_ring(geos, GEOSGetExteriorRing_r(geos.get(), geometry));
  for (int i = 0; i < GEOSGetNumInteriorRings_r(geos.get(), geometry); ++i) {
    Ring hole = read_ring(geos, GEOSGetInteriorRingN_r(geos.get(), geometry, i));
    if (hole.size() >= 3) polygon.holes.push_back(std::move(hole));
  }
  if (polygon.outer.size() >= 3 && signed_area(polygon.outer) != 0)
    result.push_back(std::move(polygon));
}

/// Where polygons overlap or share edges they become one.
std::vector<Polygon> unite(const std::vector<Polygon>& polygons) {
  const Geos geos;
  std::vector<Polygon> result;
  std::vector<GEOSGeometry*> parts;
  for (const Polygon& polygon : polygons)
    if (Geometry part = make_polygon(geos, polygon)) parts.push_back(part.release());
  if (parts.empty()) return result;
  const Geometry all(GEOSGeom_createCollection_r(geos.get(), GEOS_GEOMETRYCOLLECTION, parts.data(),
                                                 static_cast<unsigned>(parts.size())),
                     {geos.get()});
  if (all == nullptr) return result;
  const Geometry whole(GEOSUnaryUnion_r(geos.get(), all.get()), {geos.get()});
  if (whole != nullptr) read_polygons(geos, whole.get(), result);
  return result;
}

}  // namespace

void orient(Polygon& polygon) {
  const auto turn = [](Ring& ring) { std::reverse(ring.begin() + 1, ring.end()); };
  if (signed_area(polygon.outer) < 0) turn(polygon.outer);
  for (Ring& hole : polygon.holes)
    if (signed_area(hole) > 0) turn(hole);
}

FootprintResult footprint_of(const std::vector<Face>& faces) {
  FootprintResult result;
  std::vector<Polygon> polygons = ground_polygons(faces);
  if (polygons.empty()) {
    result.reason = "no face that could be a footprint";
    return result;
  }
  // One face needs no union: its vertices and their order stay.
  result.polygons = polygons.size() == 1 ? std::move(polygons) : unite(polygons);
  if (result.polygons.empty()) result.reason = "a footprint without area";
  for (Polygon& polygon : result.polygons) orient(polygon);
  return result;
}

}  // namespace tetropolis
