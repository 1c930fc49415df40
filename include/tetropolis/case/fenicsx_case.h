// A program beside a mesh: wind and smoke over a city with DOLFINx.
#pragma once

#include <filesystem>

#include "tetropolis/case/wind.h"

namespace tetropolis {

/// Writes `folder`/smoke.py, which solves the wind as a potential flow and the smoke of a chimney
/// in it (advection and diffusion) on volume.xdmf and boundary.xdmf there. Errors: kUsage for a
/// wind without speed, and for a file that is there unless `overwrite`; kInput for a folder
/// without these meshes, for a mesh with prisms, and a file that cannot be written.
void write_fenicsx_case(const std::filesystem::path& folder, const Wind& wind, bool overwrite);

}  // namespace tetropolis
