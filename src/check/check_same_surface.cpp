#include "check_same_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "vector3.h"
#include "violations.h"

namespace tetropolis {

namespace {

std::array<Vector3, 3> corners_of(const SurfaceMesh& surface, std::size_t f) {
  std::array<Vector3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = surface.points[static_cast<std::size_t>(surface.triangles[f][i])];
  return corners;
}

/// is_same(expected, f): whether face f of the file is that of the surface `expected`.
template <typename IsSame>
std::vector<Violation> compare_faces(const SurfaceMesh& boundary, std::size_t faces,
                                     const IsSame& is_same) {
  const SurfaceMesh expected = city_surface(boundary);
  std::vector<Violation> violations;
  if (faces != expected.triangles.size())
    note_violation(violations, "another number of faces than ground, roofs and walls have", [&] {
      return fmt::format("{} instead of {}", faces, expected.triangles.size());
    });
  for (std::size_t f = 0; f < std::min(faces, expected.triangles.size()); ++f)
    if (!is_same(expected, f))
      note_violation(violations, "faces that are not those of ground, roofs and walls", [&] {
        const Vector3 at = corners_of(expected, f)[0];
        return fmt::format("face {} at ({:.3f}, {:.3f}, {:.3f})", f, at[0], at[1], at[2]);
      });
  return violations;
}

}  // namespace

std::vector<Violation> check_same_surface(const SurfaceMesh& boundary, const SurfaceMesh& surface) {
  return compare_faces(
      boundary, surface.triangles.size(), [&](const SurfaceMesh& expected, std::size_t f) {
        return corners_of(expected, f) == corners_of(surface, f) &&
               expected.patch[f] == surface.patch[f] && expected.building[f] == surface.building[f];
      });
}

std::vector<Violation> check_same_surface(const SurfaceMesh& boundary, const Point3& shift,
                                          const StlMesh& surface) {
  constexpr double kRounding = std::numeric_limits<float>::epsilon();
  // The boundary's numbers may be those of a CRS, which are rounded, too.
  constexpr double kLeast = 1e-8;
  return compare_faces(boundary, surface.triangles.size(),
                       [&](const SurfaceMesh& expected, std::size_t f) {
                         const auto corners = corners_of(expected, f);
                         bool same = static_cast<int>(expected.patch[f]) == surface.attribute[f];
                         for (std::size_t i = 0; i < 3; ++i)
                           for (std::size_t d = 0; d < 3; ++d) {
                             const double x = corners[i][d] + shift[d];
                             const double y = static_cast<double>(surface.triangles[f][i][d]);
                             same = same && std::abs(x - y) <= kRounding * std::abs(x) + kLeast;
                           }
                         return same;
                       });
}

}  // namespace tetropolis
