// From OGR geometries to plain polygons. Private to src/io.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/io/vector/vector.h"

#include "io/deferred/gdal_functions.h"
#include "io/vector/quirks/turned_rings.h"

namespace tetropolis {

struct FlatGeometry {
  std::vector<PolygonPart> parts;  ///< The polygons in their order.
  bool is_of_lines = false;        ///< They are closed lines.
  bool is_body = false;            ///< They are the footprint of a body in space.
  std::int64_t courtyards = 0;     ///< Parts that became holes of others.
  int other_parts = 0;             ///< Points, lines and what is nested too deep beside them.
  std::string reason;              ///< Why there are no parts, if there are none.
};

/// Calls visit(position) for every vertex of the outline and all positions of the roofs.
template <typename Visit>
void for_each_position(Footprint& footprint, const Visit& visit) {
  for_each_vertex(footprint.polygon, visit);
  for (StatedRoof& roof : footprint.roofs) {
    for_each_vertex(roof.outline, visit);
    for (Point2& p : roof.at) visit(p);
  }
}

/// How to understand coordinates as those of a plan.
struct PlanUnits {
  bool north_first = false;      ///< The first is the northing or latitude.
  double metres_per_unit = 1;    ///< Roughly.
  double metres_per_height = 1;  ///< Of elevations.
};

/// Splits collections, straightens curves, drops Z and M, makes holes of courtyards
/// (take_courtyards_for_holes). Surfaces in space, and polygons of which several are vertical, are
/// faces of a body: the parts are its footprint then (footprint_of). `geometry` may be null. The
/// order of coordinates stays as it is.
FlatGeometry flatten(OGRGeometryH geometry, const PlanUnits& units = {});

/// The first of a layer's geometry fields that holds polygons, as far as their declared types or
/// else the first features tell; -1 if none does. Reading begins anew.
int polygon_field(OGRLayerH layer);

}  // namespace tetropolis
