#include "polygon_geometry.h"

namespace tetropolis {

namespace {

void add_ring(OGRGeometryH polygon, const Ring& ring, Point2 origin) {
  OGRGeometryH line = OGR_G_CreateGeometry(wkbLinearRing);
  for (const Point2& p : ring) OGR_G_AddPoint_2D(line, origin.x + p.x, origin.y + p.y);
  OGR_G_CloseRings(line);
  OGR_G_AddGeometryDirectly(polygon, line);
}

}  // namespace

OGRGeometryH polygon_geometry(const Polygon& polygon, Point2 origin) {
  OGRGeometryH geometry = OGR_G_CreateGeometry(wkbPolygon);
  add_ring(geometry, polygon.outer, origin);
  for (const Ring& hole : polygon.holes) add_ring(geometry, hole, origin);
  return geometry;
}

}  // namespace tetropolis
