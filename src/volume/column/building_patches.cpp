#include "tetropolis/volume/column/building_patches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "building_names.h"

namespace tetropolis {

namespace {

constexpr std::array<std::pair<PatchKind, const char*>, 2> kKinds = {
    {{PatchKind::kRoof, "roof_"}, {PatchKind::kWall, "wall_"}}};

}  // namespace

SurfaceMesh divide_by_building(const SurfaceMesh& boundary, std::span<const Building> buildings) {
  const std::vector<std::string> names = plain_names(buildings);
  SurfaceMesh result = boundary;
  std::int32_t next = 1;
  for (const PatchInfo& info : boundary.patches)
    next = std::max(next, static_cast<std::int32_t>(info.patch) + 1);
  for (const auto& [kind, prefix] : kKinds) {
    constexpr std::int32_t kNone = 0;
    std::vector<std::int32_t> number(names.size(), kNone);
    const auto for_each_face = [&, wanted = kind](const auto& visit) {
      for (std::size_t f = 0; f < boundary.patch.size(); ++f)
        if (boundary.patch_of(f).kind == wanted) visit(f, number[boundary.building[f]]);
    };
    for_each_face([](std::size_t, std::int32_t& own) { own = 1; });
    for (std::size_t b = 0; b < names.size(); ++b) {
      if (number[b] == kNone) continue;
      number[b] = next++;
      result.patches.add({static_cast<Patch>(number[b]), prefix + names[b], kind});
    }
    for_each_face(
        [&](std::size_t f, std::int32_t own) { result.patch[f] = static_cast<Patch>(own); });
  }
  sort_by_patch(result);
  return result;
}

}  // namespace tetropolis
