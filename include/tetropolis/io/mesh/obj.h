// Wavefront OBJ, for modelling programs and OpenFOAM's surface tools.
// Format: Wavefront Technologies, "Object Files (.obj)".
#pragma once

#include <filesystem>

#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Writes `surface` as text: vertices in its order, metres with six decimals, Placement::shift
/// added; faces with the orientation of `surface`, sorted by patch and building (otherwise in its
/// order), in groups "PATCH" or "PATCH building_N", that is, every face of a building belongs to
/// the group of its patch and to that of its building, N as in city.city.json. Placement::origin is
/// in a comment. The file appears complete or not at all. Throws Error(kInput) if it cannot be
/// written.
void write_obj(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement);

}  // namespace tetropolis
