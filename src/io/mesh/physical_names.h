// The section $PhysicalNames of MSH files of both versions.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/mesh/msh.h"

#include "column_output.h"

namespace tetropolis {

/// Patches by their number, and the air.
inline std::string physical_names(const std::vector<PatchFaces>& patches,
                                  const SurfaceMesh& surface) {
  std::string text = fmt::format("$PhysicalNames\n{}\n", patches.size() + 1);
  for (const PatchFaces& range : patches)
    text += fmt::format("2 {} \"{}\"\n", static_cast<int>(range.patch),
                        surface.patches.of(range.patch).name);
  return text + fmt::format("3 {} \"air\"\n$EndPhysicalNames\n", kAirPhysicalGroup);
}

}  // namespace tetropolis
