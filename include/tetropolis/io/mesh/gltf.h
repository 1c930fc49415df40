// glTF 2.0 in one binary file (GLB), for looking at a city in a browser or a game engine.
// Format: Khronos Group, "glTF 2.0 Specification" (ISO/IEC 12113:2022).
#pragma once

#include <filesystem>

#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Writes `surface` as one node, mesh and material per patch that has faces, named after it,
/// each with its own vertices: positions in single precision (x, z, -y), as glTF's y axis points
/// up, always in the local frame, since the numbers of a CRS do not fit into single precision.
/// Faces have the orientation of `surface`; there are no normals, for which viewers shade flat. The
/// position of the local zero in the CRS, shift + origin of `placement` in the CRS's axes, is
/// asset.extras.origin. The file appears complete or not at all. Throws Error(kInput) if it cannot
/// be written or needs more than the format's 4 GiB (about 150 million triangles).
void write_glb(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement);

}  // namespace tetropolis
