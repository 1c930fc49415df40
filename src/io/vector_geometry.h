// From OGR geometries to plain polygons. Private to src/io.
#pragma once

#include <string>
#include <vector>

#include <ogr_api.h>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// One polygon of a feature: usable if `reason` is empty, else to be dropped for it.
struct PolygonPart {
  Polygon polygon;
  std::string reason;
};

struct FlatGeometry {
  std::vector<PolygonPart> parts;  ///< The polygons in their order.
  int other_parts = 0;             ///< Points, lines and what is nested too deep beside them.
  std::string reason;              ///< Why there are no parts, if there are none.
};

/// Splits collections, straightens curves, drops Z and M. A part within a part and turned against
/// it becomes a hole of that, and its own holes parts; one that stands in a hole of the other is
/// not within it and stays. `geometry` may be null.
FlatGeometry flatten(OGRGeometryH geometry);

/// A hole that encloses its shell becomes the shell. Some files have the yard first; and GDAL tells
/// the rings of a shapefile apart by their turn, so where a writer turned all of them the wrong
/// way, it takes the yard for the building and the building for a hole in it.
void mend_order_of_rings(FlatGeometry& geometry);

/// For shapefiles, which tell shells from holes by their turn. Where all rings turn as holes do,
/// each is a polygon for GDAL: every other one of those within each other becomes a hole.
void mend_turned_rings(FlatGeometry& geometry);

/// Whether a layer of this geometry type may hold polygons.
bool may_hold_polygons(OGRwkbGeometryType type);

}  // namespace tetropolis
