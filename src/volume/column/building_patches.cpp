#include "tetropolis/volume/column/building_patches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
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
  std::vector<std::size_t> order(result.patch.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return result.patch[a] < result.patch[b]; });
  const auto sort = [&](auto& values) {
    if (values.empty()) return;
    auto sorted = values;
    for (std::size_t f = 0; f < order.size(); ++f) sorted[f] = values[order[f]];
    values = std::move(sorted);
  };
  sort(result.triangles);
  sort(result.patch);
  sort(result.building);
  sort(result.cell);
  // The halves of a quadrilateral have one patch, so they stay together.
  std::vector<std::uint8_t> is_first_half(order.size(), 0);
  for (const std::int32_t f : boundary.quads) is_first_half[static_cast<std::size_t>(f)] = 1;
  sort(is_first_half);
  result.quads.clear();
  for (std::size_t f = 0; f < is_first_half.size(); ++f)
    if (is_first_half[f] != 0) result.quads.push_back(static_cast<std::int32_t>(f));
  return result;
}

}  // namespace tetropolis
