// From the roofs of a building of another program to parts. Private to src/io.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/stated_roof.h"

#include "body_footprint.h"

namespace tetropolis {

/// Parts and the footprint that they tile, or why there are none.
struct BodyParts {
  Polygon footprint;
  std::vector<RoofPart> parts;
  std::string reason;  ///< A clause such as "roofs that overlap".
};

/// One part per face whose semantics say RoofSurface: its plan, and the plane nearest to its
/// vertices. Vertices of the plan within a centimetre of each other are one; those as near to an
/// edge become vertices of it. The footprint is what the parts cover together.
///
/// No parts where the faces do not tile one piece (gaps, overlaps) that is the ground's plan to a
/// centimetre along its outline; where a face is vertical, more than 5 cm off a plane, or not above
/// `low` by as much; where they have more than 10,000 corners. None, and no reason, if all there is
/// is one level face.
///
/// The parts have no source_id and no points. `ground`: valid, oriented.
BodyParts parts_of(std::span<const Face> faces, const Polygon& ground, double low, Lod lod);

/// A roof plane over `outline`, as heights above `ground`.
StatedRoof stated_roof(const Polygon& outline, const RoofPlane& plane, double ground);

/// All that is above a body, whether it tiles its ground or not: one per face whose semantics say
/// RoofSurface, or, where none does, per face that is not vertical; by the planes nearest to them.
std::vector<StatedRoof> stated_roofs(std::span<const Face> faces, double ground);

}  // namespace tetropolis
