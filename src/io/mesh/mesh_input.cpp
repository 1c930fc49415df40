#include "mesh_input.h"

#include <locale>
#include <sstream>

#include <fmt/format.h>

#include "io/file/input_file.h"

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

std::optional<Point3> point_from_text(const std::string& text) {
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  Point3 point{};
  std::string rest;
  if (!(words >> point[0] >> point[1] >> point[2]) || words >> rest) return std::nullopt;
  return point;
}

}  // namespace tetropolis
