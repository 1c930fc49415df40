// What is written of a boundary to look at, against the boundary.
#pragma once

#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Whether `surface` is city_surface() of `boundary`: the same corners, patches and buildings, face
/// by face.
std::vector<Violation> check_same_surface(const SurfaceMesh& boundary, const SurfaceMesh& surface);

/// The same of an STL file: corners in single precision, patches. `shift`: from the boundary's
/// coordinates to the file's.
std::vector<Violation> check_same_surface(const SurfaceMesh& boundary, const Point3& shift,
                                          const StlMesh& surface);

}  // namespace tetropolis
