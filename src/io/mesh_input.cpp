#include "mesh_input.h"

#include <fmt/format.h>

#include "input_file.h"

namespace tetropolis {

namespace {

// TetMesh, and what check_volume takes beside it.
constexpr double kPerPoint = 28;
constexpr double kPerCell = 56;
// SurfaceMesh, and its patches as numbers.
constexpr double kPerSurfacePoint = 24;
constexpr double kPerTriangle = 24;

constexpr const char* kRemedy = "use a machine with more memory";

}  // namespace

void require_room_for_mesh(const std::filesystem::path& path, std::uint64_t points,
                           std::uint64_t cells) {
  require_memory(path,
                 kPerPoint * static_cast<double>(points) + kPerCell * static_cast<double>(cells),
                 fmt::format("read and check its {} cells", cells), kRemedy);
}

void require_room_for_surface(const std::filesystem::path& path, std::uint64_t points,
                              std::uint64_t triangles) {
  require_memory(path,
                 kPerSurfacePoint * static_cast<double>(points) +
                     kPerTriangle * static_cast<double>(triangles),
                 fmt::format("read its {} points and {} triangles", points, triangles), kRemedy);
}

}  // namespace tetropolis
