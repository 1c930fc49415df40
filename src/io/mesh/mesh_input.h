// What the readers of meshes share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/surfaces.h"
#include "tetropolis/volume/column/boundary.h"

#include "core/is_among.h"

namespace tetropolis {

/// Throws Error(kInput) if the machine has not the memory for so many points and tets and for what
/// checking them takes.
void require_room_for_mesh(const std::filesystem::path& path, std::uint64_t points,
                           std::uint64_t cells);

/// The same for a surface, without checking it.
void require_room_for_surface(const std::filesystem::path& path, std::uint64_t points,
                              std::uint64_t triangles);

/// Three numbers as text with blanks between; nothing if that is not what it is.
std::optional<Point3> point_from_text(const std::string& text);

using PatchNames = std::map<std::int32_t, std::string>;

/// Sets the patch of each face. What no city has by itself is named by `names`, else "patch9" or
/// the like, and of no known kind, but for those of surface layers: ground. fail(what) is called
/// for the first number that is none, and must throw.
template <typename Fail>
void set_patches(const std::vector<std::int32_t>& numbers, const PatchNames& names,
                 SurfaceMesh& surface, const Fail& fail) {
  surface.patch.reserve(numbers.size());
  for (std::size_t f = 0; f < numbers.size(); ++f) {
    const std::string number = std::to_string(numbers[f]);
    if (numbers[f] < 1)
      fail("face " + std::to_string(f) + " has the patch " + number + "; 1 or more expected");
    const auto patch = static_cast<Patch>(numbers[f]);
    if (!surface.patches.contains(patch)) {
      const auto name = names.find(numbers[f]);
      const bool is_named = name != names.end();
      const bool is_surface = is_named && is_among(name->second, kSurfaceKindNames);
      surface.patches.add({patch, is_named ? name->second : "patch" + number,
                           is_surface ? PatchKind::kGround : PatchKind::kOther});
    }
    surface.patch.push_back(patch);
  }
}

}  // namespace tetropolis
