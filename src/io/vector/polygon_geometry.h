// From plain polygons to OGR geometries. Private to src/io.
#pragma once

#include <ogr_api.h>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A new polygon, closed, with `origin` added to its coordinates.
OGRGeometryH polygon_geometry(const Polygon& polygon, Point2 origin = {});

}  // namespace tetropolis
