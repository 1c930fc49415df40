// What MSH files of both versions have in common: types of elements, and names of groups.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/mesh/msh.h"

#include "column_output.h"

namespace tetropolis {

inline constexpr int kMshTriangle = 2, kMshQuad = 3, kMshTet = 4, kMshPrism = 6;

/// Of the cells with this number of CellZones::of_cell.
inline int volume_group(std::int32_t zone) { return kAirPhysicalGroup + zone; }

/// Numbers of CellZones::of_cell that cells have: 0 first.
inline std::vector<std::int32_t> volumes_of(const CellZones& zones) {
  std::vector<std::int32_t> volumes{0};
  for (std::size_t i = 0; i < zones.zones.size(); ++i)
    if (zones.zones[i].cells > 0) volumes.push_back(static_cast<std::int32_t>(i) + 1);
  return volumes;
}

/// The section $PhysicalNames: patches by their number, the air and zones in it.
inline std::string physical_names(const std::vector<PatchFaces>& patches,
                                  const SurfaceMesh& surface, const CellZones& zones) {
  const std::vector<std::int32_t> volumes = volumes_of(zones);
  std::string text = fmt::format("$PhysicalNames\n{}\n", patches.size() + volumes.size());
  for (const PatchFaces& range : patches)
    text += fmt::format("2 {} \"{}\"\n", static_cast<int>(range.patch),
                        surface.patches.of(range.patch).name);
  for (const std::int32_t zone : volumes)
    text += fmt::format("3 {} \"{}\"\n", volume_group(zone),
                        zone == 0 ? "air" : zones.zones[static_cast<std::size_t>(zone) - 1].name);
  return text + "$EndPhysicalNames\n";
}

}  // namespace tetropolis
