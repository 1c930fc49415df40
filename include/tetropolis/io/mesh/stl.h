// STL, the format that every geometry program reads.
#pragma once

#include <filesystem>

#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Writes `surface` as ASCII STL with one solid per patch that has faces, named after it.
/// Metres with six decimals; equal vertices are written equally, so the surface stays watertight.
/// The file appears complete or not at all. Throws Error(kInput) if it cannot be written.
void write_stl(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement);

}  // namespace tetropolis
