// Binary STL, the format that every geometry program reads.
// Format: 3D Systems, "StereoLithography Interface Specification", 1988.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Writes `surface` in its order and orientation: positions in single precision, always in the
/// local frame, since the numbers of a CRS do not fit into single precision; equal vertices are
/// written equally, so the surface stays watertight. The two bytes behind each triangle are its
/// patch. The header says "tetropolis origin X Y Z": the position of the local zero in the CRS,
/// shift + origin of `placement`. The file appears complete or not at all. Throws Error(kInput) if
/// it cannot be written.
void write_stl(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement);

struct StlMesh {
  std::vector<std::array<std::array<float, 3>, 3>> triangles;  ///< Corners.
  std::vector<std::uint16_t> attribute;  ///< Per triangle; of write_stl: its patch.
  std::optional<Point3> origin;          ///< If the header has it as write_stl does.
};

/// Reads binary STL of any program. Throws Error(kInput) naming the file and what is wrong or not
/// supported, also if the machine has not the memory for so many triangles.
StlMesh read_stl(const std::filesystem::path& path);

}  // namespace tetropolis
