// From the faces of a building in space to its footprint. Private to src/io.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "io/file/json_place.h"

namespace tetropolis {

/// A planar face: outer ring and inner rings, local frame.
struct Face {
  std::vector<std::vector<Point3>> rings;
  bool is_ground = false;                         ///< Semantics say GroundSurface.
  bool is_roof = false;                           ///< Semantics say RoofSurface.
  std::optional<Place> semantics = std::nullopt;  ///< Of a roof.
};

/// Least and greatest.
std::pair<double, double> elevations(const Face& face);

/// Whether a face is vertical, within half a degree, and a decimetre to 1,100 m high.
bool is_wall(const Face& face);

struct FootprintResult {
  std::vector<Polygon> polygons;  ///< Outer counter-clockwise, holes clockwise, snapped.
  std::string reason;             ///< Why there are none.
};

/// Union of the ground faces in the plan, as described at read_city. Precondition: coordinates in
/// metres or so: they are put on the grid of coordinates.
FootprintResult footprint_of(const std::vector<Face>& faces);

/// The height, above 0, that nine tenths of the roof's area in the plan do not exceed, as the 90th
/// percentile of points scanned from above would be: of the faces that look up and whose semantics
/// say that they are roofs; or, if these are less than most of the footprint, the height above
/// which the faces that look up have a tenth of the footprint's area (all of those above each
/// other). None unless these are most of the footprint, or if as much looks down above that.
std::optional<double> roof_height_of(std::span<const Face> faces, double area_of_footprint);

/// The faces that belong to each of several (one or more) disjoint footprints: those with a point
/// in the plan that is in it, or nearest to it.
std::vector<std::vector<Face>> share_out(const std::vector<Face>& faces,
                                         const std::vector<Polygon>& footprints);

/// Turns rings so that the outer one is counter-clockwise and holes are clockwise; the first vertex
/// of each stays the first.
void orient(Polygon& polygon);

}  // namespace tetropolis
