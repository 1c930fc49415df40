// Guarantee 6 on a written boundary, its terrain and its city model.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column/boundary.h"

#include "volume/excavate/excavate.h"

namespace tetropolis {

struct HeightsCheck {
  std::int64_t ground_vertices = 0;
  std::int64_t roof_vertices = 0;
  std::int64_t lowered = 0;  ///< Ground vertices below the DTM by more than the tolerance.
  /// Those at a wall of just `minimum_wall` (to 1e-6 m) and on the DTM within the tolerance:
  /// whether they were lowered by a rounding error, nobody can tell.
  std::int64_t perhaps_lowered = 0;
  /// Vertices of a part's roof that are off its plane by more than a centimetre, because another
  /// part's is there, too: see below.
  std::int64_t roof_snapped = 0;
  double most_snapped = 0;  ///< By so much at most, metres.
  std::vector<Violation> violations;
};

/// |z - DTM| <= 1e-9 m at ground vertices; at roof vertices |z - h_roof| <= 1e-9 m, or, of
/// buildings with parts, as much from the plane of the part that the face is over, and what
/// rounding of coordinates makes on its slope. Where other parts touch the vertex, too, it may be
/// anywhere between the lowest and the highest of their planes: roofs that nearly meet are made to.
///
/// On walls ground may lie below the DTM where that, at the vertex or at one next to it, is higher
/// than the roof less `minimum_wall`, metres; and anywhere where it was excavated (see excavate):
/// exactly so far (to 1e-5 m) from the sources, in the local frame; or, if these are not known, no
/// further than slopes of 30 degrees from a roof beside it or from the ground at its neighbours;
/// walls, which may be toes, are then taken for sound. `shift` is added to the surface's
/// coordinates to get to the local frame of `dtm` and `city`. Ground vertices that are not finite
/// are violations.
///
/// `layers`: height of the layers of prisms at each vertex, or empty. Walls and excavations are
/// those above them.
HeightsCheck check_heights(const SurfaceMesh& surface, std::array<double, 3> shift,
                           const Raster& dtm, const CityModel& city, double minimum_wall,
                           const std::optional<ExcavationSources>& excavated,
                           const std::vector<double>& layers = {});

}  // namespace tetropolis
