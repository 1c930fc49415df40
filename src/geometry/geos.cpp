#include "geos.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <geos_c.h>

#include "tetropolis/geometry/polygon.h"

namespace tetropolis::geos {

namespace {

class Context {
 public:
  Context() : handle_(GEOS_init_r()) {}
  ~Context() { GEOS_finish_r(handle_); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  GEOSContextHandle_t get() const { return handle_; }

 private:
  GEOSContextHandle_t handle_;
};

class Geometry {
 public:
  Geometry(const Context& context, GEOSGeometry* geometry)
      : context_(&context), geometry_(geometry) {}
  ~Geometry() {
    if (geometry_ != nullptr) GEOSGeom_destroy_r(context_->get(), geometry_);
  }
  Geometry(Geometry&& other) noexcept
      : context_(other.context_), geometry_(std::exchange(other.geometry_, nullptr)) {}
  Geometry& operator=(Geometry&&) = delete;
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  GEOSGeometry* get() const { return geometry_; }
  GEOSGeometry* release() { return std::exchange(geometry_, nullptr); }

 private:
  const Context* context_;
  GEOSGeometry* geometry_;
};

GEOSGeometry* make_ring(const Context& context, const Ring& ring) {
  std::vector<double> xy;
  xy.reserve(2 * ring.size() + 2);
  for (const Point2 p : ring) {
    xy.push_back(p.x);
    xy.push_back(p.y);
  }
  xy.push_back(ring[0].x);
  xy.push_back(ring[0].y);
  GEOSCoordSequence* sequence = GEOSCoordSeq_copyFromBuffer_r(
      context.get(), xy.data(), static_cast<unsigned>(ring.size() + 1), 0, 0);
  return sequence == nullptr ? nullptr : GEOSGeom_createLinearRing_r(context.get(), sequence);
}

/// Null where GEOS fails. Holes of fewer than three vertices are left out.
Geometry make_polygon(const Context& context, const Polygon& polygon) {
  if (polygon.outer.size() < 3) return {context, nullptr};
  Geometry shell(context, make_ring(context, polygon.outer));
  std::vector<GEOSGeometry*> holes;
  bool made = shell.get() != nullptr;
  for (const Ring& hole : polygon.holes) {
    if (hole.size() < 3) continue;
    GEOSGeometry* ring = made ? make_ring(context, hole) : nullptr;
    made = ring != nullptr;
    if (!made) break;
    holes.push_back(ring);
  }
  if (!made) {
    for (GEOSGeometry* hole : holes) GEOSGeom_destroy_r(context.get(), hole);
    return {context, nullptr};
  }
  return {context, GEOSGeom_createPolygon_r(context.get(), shell.release(), holes.data(),
                                            static_cast<unsigned>(holes.size()))};
}

/// Null where GEOS fails. Polygons of fewer than three vertices are left out.
Geometry make_collection(const Context& context, std::span<const Polygon> polygons, int type) {
  std::vector<GEOSGeometry*> parts;
  parts.reserve(polygons.size());
  for (const Polygon& polygon : polygons) {
    if (polygon.outer.size() < 3) continue;
    Geometry part = make_polygon(context, polygon);
    if (part.get() == nullptr) {
      for (GEOSGeometry* made : parts) GEOSGeom_destroy_r(context.get(), made);
      return {context, nullptr};
    }
    parts.push_back(part.release());
  }
  return {context, GEOSGeom_createCollection_r(context.get(), type, parts.data(),
                                               static_cast<unsigned>(parts.size()))};
}

Ring read_ring(const Context& context, const GEOSGeometry* geometry, bool counter_clockwise) {
  const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(context.get(), geometry);
  unsigned size = 0;
  if (sequence == nullptr || GEOSCoordSeq_getSize_r(context.get(), sequence, &size) == 0 ||
      size < 4)
    return {};
  std::vector<double> xy(2 * static_cast<std::size_t>(size));
  if (GEOSCoordSeq_copyToBuffer_r(context.get(), sequence, xy.data(), 0, 0) == 0) return {};
  Ring ring(size - 1);
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = {xy[2 * i], xy[2 * i + 1]};
  if ((signed_area(ring) > 0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
  // A canonical start, so that the result does not depend on how the operation was carried out.
  const auto first = std::min_element(ring.begin(), ring.end(), [](Point2 a, Point2 b) {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
  });
  std::rotate(ring.begin(), first, ring.end());
  return ring;
}

void collect(const Context& context, const GEOSGeometry* geometry, std::vector<Polygon>& out) {
  const int type = GEOSGeomTypeId_r(context.get(), geometry);
  if (type == GEOS_POLYGON) {
    if (GEOSisEmpty_r(context.get(), geometry) != 0) return;
    Polygon polygon;
    polygon.outer = read_ring(context, GEOSGetExteriorRing_r(context.get(), geometry), true);
    if (polygon.outer.empty()) return;
    const int holes = GEOSGetNumInteriorRings_r(context.get(), geometry);
    for (int i = 0; i < holes; ++i) {
      Ring hole = read_ring(context, GEOSGetInteriorRingN_r(context.get(), geometry, i), false);
      if (!hole.empty()) polygon.holes.push_back(std::move(hole));
    }
    out.push_back(std::move(polygon));
  } else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
    const int parts = GEOSGetNumGeometries_r(context.get(), geometry);
    for (int i = 0; i < parts; ++i)
      collect(context, GEOSGetGeometryN_r(context.get(), geometry, i), out);
  }
}

Result read(const Context& context, const Geometry& geometry) {
  if (geometry.get() == nullptr) return std::nullopt;
  std::vector<Polygon> polygons;
  collect(context, geometry.get(), polygons);
  for (Polygon& polygon : polygons)
    std::sort(polygon.holes.begin(), polygon.holes.end(), comes_before);
  std::sort(polygons.begin(), polygons.end(),
            [](const Polygon& a, const Polygon& b) { return comes_before(a.outer, b.outer); });
  return polygons;
}

}  // namespace

bool comes_before(const Ring& a, const Ring& b) {
  return a[0].y < b[0].y || (a[0].y == b[0].y && a[0].x < b[0].x);
}

Result unite(std::span<const Polygon> polygons, double grid) {
  // The union of a collection would sort the two into a tree first.
  if (polygons.size() == 2 && !(grid > 0)) return join(polygons.first(1), polygons.last(1), grid);
  const Context context;
  const Geometry input = make_collection(context, polygons, GEOS_GEOMETRYCOLLECTION);
  if (input.get() == nullptr) return std::nullopt;
  // The union of one polygon would be that polygon, on the grid or not.
  if (polygons.size() == 1 && grid > 0)
    return read(context, {context, GEOSGeom_setPrecision_r(context.get(), input.get(), grid, 0)});
  return read(context, {context, grid > 0 ? GEOSUnaryUnionPrec_r(context.get(), input.get(), grid)
                                          : GEOSUnaryUnion_r(context.get(), input.get())});
}

Result join(std::span<const Polygon> a, std::span<const Polygon> b, double grid) {
  const Context context;
  const Geometry left = make_collection(context, a, GEOS_MULTIPOLYGON);
  const Geometry right = make_collection(context, b, GEOS_MULTIPOLYGON);
  if (left.get() == nullptr || right.get() == nullptr) return std::nullopt;
  return read(context,
              {context, grid > 0 ? GEOSUnionPrec_r(context.get(), left.get(), right.get(), grid)
                                 : GEOSUnion_r(context.get(), left.get(), right.get())});
}

Result subtract(std::span<const Polygon> a, std::span<const Polygon> b, double grid) {
  const Context context;
  const Geometry left = make_collection(context, a, GEOS_MULTIPOLYGON);
  const Geometry parts = make_collection(context, b, GEOS_GEOMETRYCOLLECTION);
  if (left.get() == nullptr || parts.get() == nullptr) return std::nullopt;
  const Geometry right(context, GEOSUnaryUnion_r(context.get(), parts.get()));
  if (right.get() == nullptr) return std::nullopt;
  return read(
      context,
      {context, grid > 0 ? GEOSDifferencePrec_r(context.get(), left.get(), right.get(), grid)
                         : GEOSDifference_r(context.get(), left.get(), right.get())});
}

Result intersect(std::span<const Polygon> a, std::span<const Polygon> b, double grid) {
  const Context context;
  const Geometry left = make_collection(context, a, GEOS_MULTIPOLYGON);
  const Geometry right = make_collection(context, b, GEOS_MULTIPOLYGON);
  if (left.get() == nullptr || right.get() == nullptr) return std::nullopt;
  return read(
      context,
      {context, grid > 0 ? GEOSIntersectionPrec_r(context.get(), left.get(), right.get(), grid)
                         : GEOSIntersection_r(context.get(), left.get(), right.get())});
}

Result offset(std::span<const Polygon> polygons, double distance) {
  constexpr int kQuadrantSegments = 8;  // of round ends, which there are none of
  constexpr double kMitreLimit = 5;     // half a corner of 23 degrees has the sine 1/5
  const Context context;
  const Geometry input = make_collection(context, polygons, GEOS_MULTIPOLYGON);
  if (input.get() == nullptr) return std::nullopt;
  return read(context, {context, GEOSBufferWithStyle_r(context.get(), input.get(), distance,
                                                       kQuadrantSegments, GEOSBUF_CAP_FLAT,
                                                       GEOSBUF_JOIN_MITRE, kMitreLimit)});
}

Result faces(std::span<const Polygon> polygons, double grid) {
  const Context context;
  std::vector<GEOSGeometry*> rings;
  const auto add = [&](const Ring& ring) {
    if (ring.size() < 3) return;
    if (GEOSGeometry* made = make_ring(context, ring)) rings.push_back(made);
  };
  for (const Polygon& polygon : polygons) for_each_ring(polygon, add);
  const Geometry lines(
      context, GEOSGeom_createCollection_r(context.get(), GEOS_MULTILINESTRING, rings.data(),
                                           static_cast<unsigned>(rings.size())));
  if (lines.get() == nullptr) return std::nullopt;
  const Geometry noded(context, GEOSUnaryUnionPrec_r(context.get(), lines.get(), grid));
  if (noded.get() == nullptr) return std::nullopt;
  const GEOSGeometry* const input = noded.get();
  return read(context, {context, GEOSPolygonize_r(context.get(), &input, 1)});
}

bool is_valid(std::span<const Polygon> polygons) {
  const Context context;
  const Geometry input = make_collection(context, polygons, GEOS_MULTIPOLYGON);
  return input.get() != nullptr && GEOSisValid_r(context.get(), input.get()) == 1;
}

Result make_valid(const Polygon& polygon) {
  const Context context;
  const Geometry input = make_polygon(context, polygon);
  if (input.get() == nullptr) return std::nullopt;
  GEOSMakeValidParams* parameters = GEOSMakeValidParams_create_r(context.get());
  GEOSMakeValidParams_setMethod_r(context.get(), parameters, GEOS_MAKE_VALID_STRUCTURE);
  GEOSMakeValidParams_setKeepCollapsed_r(context.get(), parameters, 0);
  Geometry valid(context, GEOSMakeValidWithParams_r(context.get(), input.get(), parameters));
  GEOSMakeValidParams_destroy_r(context.get(), parameters);
  return read(context, valid);
}

}  // namespace tetropolis::geos
