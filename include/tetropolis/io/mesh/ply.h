// Stanford PLY, binary little endian.
// Format: Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include <filesystem>

#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Writes `surface` in its order and orientation: vertices x, y, z in double precision,
/// Placement::shift added; faces as vertex_indices (a list of three ints), patch (int, see
/// Patch) and building (int, -1 where none). Placement::origin is in a comment.
/// The file appears complete or not at all. Throws Error(kInput) if it cannot be written.
void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement);

}  // namespace tetropolis
