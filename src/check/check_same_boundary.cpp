#include "check_same_boundary.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>

#include "core/ragged_builder.h"
#include "geometry/square_grid.h"
#include "vector3.h"
#include "violations.h"

namespace tetropolis {

namespace {

/// `of_volume`, `of_surface`: faces by the points of each.
template <std::size_t Corners>
std::vector<Violation> compare_faces(const TetMesh& mesh,
                                     const std::vector<std::array<std::int64_t, Corners>>& volume,
                                     const SurfaceMesh& surface,
                                     const std::vector<std::array<std::int32_t, Corners>>& others) {
  // Faces by the bits of their corners' coordinates, in some order: both files write the same
  // doubles, and unlike these their bits are equal to themselves and ordered whatever they say.
  using Bits = std::array<std::uint64_t, 3>;
  using FaceKey = std::array<Bits, Corners>;
  const std::size_t of_volume = volume.size();
  const std::size_t faces = of_volume + others.size();
  const auto key_of = [&](std::size_t f) {
    FaceKey key;
    for (std::size_t i = 0; i < Corners; ++i) {
      const Vector3& p = f < of_volume
                             ? mesh.points[static_cast<std::size_t>(volume[f][i])]
                             : surface.points[static_cast<std::size_t>(others[f - of_volume][i])];
      // No sum is -0.
      for (std::size_t d = 0; d < 3; ++d) key[i][d] = std::bit_cast<std::uint64_t>(p[d] + 0.0);
    }
    std::sort(key.begin(), key.end());
    return key;
  };
  const auto first_corner = [](const FaceKey& key) {
    return Vector3{std::bit_cast<double>(key[0][0]), std::bit_cast<double>(key[0][1]),
                   std::bit_cast<double>(key[0][2])};
  };
  const SquareGrid grid(box_of(surface.points), faces / 8);
  const RaggedArray<std::uint32_t> filed = file_under_rows(
      faces, grid.size(),
      [&](std::size_t f, const auto& use) { use(grid.at(first_corner(key_of(f)))); });
  const auto look = [&](std::size_t begin, std::size_t end, std::vector<Violation>& violations) {
    struct Face {
      std::uint64_t sum;  // of elevations' bits: tells most faces apart
      FaceKey key;
      int side;  // +1: of the volume, -1: of the surface
    };
    std::vector<Face> row;
    for (std::size_t r = begin; r < end; ++r) {
      row.clear();
      for (const std::uint32_t item : filed[r]) {
        const std::size_t f = item;
        const FaceKey key = key_of(f);
        std::uint64_t sum = 0;
        for (const Bits& corner : key) sum += corner[2];
        row.push_back({sum, key, f < of_volume ? 1 : -1});
      }
      std::sort(row.begin(), row.end(), [](const Face& a, const Face& b) {
        return a.sum != b.sum ? a.sum < b.sum : a.key < b.key;
      });
      for (std::size_t i = 0, j = 0; i < row.size(); i = j) {
        int surplus = 0;
        for (; j < row.size() && row[j].key == row[i].key; ++j) surplus += row[j].side;
        const Vector3 at = first_corner(row[i].key);
        for (int n = 0; n < std::abs(surplus); ++n)
          note_violation(violations, "boundary faces in only one of volume and surface", [&] {
            return fmt::format("at ({:.3f}, {:.3f}, {:.3f})", at[0], at[1], at[2]);
          });
      }
    }
  };
  return sum_of_violations(filed.size(), look);
}

}  // namespace

std::vector<Violation> check_same_boundary(const TetMesh& mesh, const VolumeCheck& volume,
                                           const SurfaceMesh& surface) {
  if (surface.quads.empty() && volume.boundary_quads.empty())
    return compare_faces<3>(mesh, volume.boundary, surface, surface.triangles);
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::array<std::int32_t, 4>> quads;
  auto quad = surface.quads.begin();
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& [a, b, c] = surface.triangles[f];
    if (quad == surface.quads.end() || static_cast<std::size_t>(*quad) != f) {
      triangles.push_back({a, b, c});
      continue;
    }
    ++quad;
    quads.push_back({a, b, c, surface.triangles[++f][2]});
  }
  std::vector<Violation> violations = compare_faces<3>(mesh, volume.boundary, surface, triangles);
  add_violations(violations, compare_faces<4>(mesh, volume.boundary_quads, surface, quads));
  return violations;
}

}  // namespace tetropolis
