// Guarantee 3 on a written boundary and its city model.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/volume/column/boundary.h"

#include "core/infinity.h"

namespace tetropolis {

/// The ground mesh, as ground and roof faces show it in the plan. Their coordinates are those of
/// the ground mesh, rounded to doubles in the reference system; so its angles are known within
/// bounds only.
struct GroundCheck {
  std::int64_t triangles = 0;
  double least_angle_deg = kInfinity;  ///< As written.
  /// The least angle before rounding is at least and at most this.
  std::array<double, 2> least_angle_bounds_deg{kInfinity, kInfinity};
  std::int64_t below = 0;  ///< Triangles below the minimum angle less 1e-6 degrees, as written.
  /// Before rounding, at least so many were below that, and at most so many below the minimum.
  std::array<std::int64_t, 2> below_bounds{};
  std::vector<Violation> violations;
};

/// Measures the angles; looks whether those more than a ten-thousandth of a degree below the
/// minimum are where the input has a sharper corner (check_angles in ground/validate.h), and
/// whether every edge of a footprint, or of a part, is a union of edges of the mesh: the outline of
/// each roof in the plan has all vertices of its part, and its length. `shift` is added to the
/// surface's coordinates to get to the local frame of `city`.
GroundCheck check_ground(const SurfaceMesh& surface, std::array<double, 3> shift,
                         const CityModel& city, double min_angle_deg);

}  // namespace tetropolis
