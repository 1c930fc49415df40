// Courtyards that their file does not give as holes of a polygon. Private to src/io.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "io/cityjson/body_footprint.h"

namespace tetropolis {

/// One polygon of a feature: usable if `reason` is empty, else to be dropped for it.
struct PolygonPart {
  Polygon polygon;
  std::string reason;
};

/// Of several courtyards in a shapefile GDAL makes polygons of their own: parts within a part,
/// turned against it (mapshaper's issue 538). They become holes again, and what stands in them
/// parts; parts that turn alike stay parts, whatever they overlap, and so does one that leaves less
/// than a wall of the other. So do the roof and the ground of a building, of which one looks down.
/// `faces`: of the parts, or none. Returns how many courtyards there are.
std::int64_t take_courtyards_for_holes(std::vector<PolygonPart>& parts,
                                       const std::vector<Face>& faces, double metres_per_unit);

/// Where the courtyard comes first and its building second, as their turns say too (holes
/// clockwise), the building becomes the shell.
void mend_order_of_rings(std::vector<PolygonPart>& parts);

/// For shapefiles, which tell shells from holes by their turn, written by programs that do not care
/// for it (pyshp writes rings as it gets them). Where all rings turn the wrong way, GDAL takes the
/// courtyard for the shell: the widest ring of each part becomes its shell again. Where all turn as
/// holes do, each is a polygon for GDAL: every other one of those within each other becomes a hole.
void mend_turned_rings(std::vector<PolygonPart>& parts);

}  // namespace tetropolis
