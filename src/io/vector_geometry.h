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

/// Where the yard comes first and its building second, as their turns say too (holes clockwise),
/// the building becomes the shell.
void mend_order_of_rings(FlatGeometry& geometry);

/// For shapefiles, which tell shells from holes by their turn. Where all rings turn the wrong way,
/// GDAL takes the yard for the shell: the widest ring of each part becomes its shell again. Where
/// all turn as holes do, each is a polygon for GDAL: every other one of those within each other
/// becomes a hole.
void mend_turned_rings(FlatGeometry& geometry);

/// Whether a layer holds polygons, as far as its declared type or else its first features tell.
/// Reading begins anew.
bool holds_polygons(OGRLayerH layer);

}  // namespace tetropolis
