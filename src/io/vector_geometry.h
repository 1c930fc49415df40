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
  int other_parts = 0;             ///< Points and lines beside them.
  std::string reason;              ///< Why there are no parts, if there are none.
};

/// Splits collections, straightens curves, drops Z and M. `geometry` may be null.
FlatGeometry flatten(OGRGeometryH geometry);

/// For shapefiles, which tell shells from holes by their turn: undoes what GDAL makes of rings that
/// all turn the wrong way. The widest ring of a part becomes its shell, and a part within a part
/// and turned against it a hole of that.
void untangle_turned_rings(FlatGeometry& geometry);

/// Whether a layer of this geometry type may hold polygons.
bool may_hold_polygons(OGRwkbGeometryType type);

}  // namespace tetropolis
