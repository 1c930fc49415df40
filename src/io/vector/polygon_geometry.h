// From plain polygons to OGR geometries. Private to src/io.
#pragma once

#include "tetropolis/geometry/types.h"

#include "io/deferred/gdal_functions.h"

namespace tetropolis {

/// A new polygon, closed, with `origin` added to its coordinates.
OGRGeometryH polygon_geometry(const Polygon& polygon, Point2 origin = {});

}  // namespace tetropolis
