// Guarantee 5 between a written volume and a written boundary.
#pragma once

#include <vector>

#include "tetropolis/check/check_volume.h"
#include "tetropolis/check/violation.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Whether the faces of `surface` are exactly the boundary faces of the volume, by coordinates (0
/// and -0 are the same; what is not finite is the same if its bits are).
std::vector<Violation> check_same_boundary(const TetMesh& mesh, const VolumeCheck& volume,
                                           const SurfaceMesh& surface);

}  // namespace tetropolis
