// Steps 1.1 and 1.2: the files of a run.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/in_memory.h"

#include "core/step_clock.h"

namespace tetropolis {

/// What is to be made of a city.
enum class Next { kNothing, kMesh };

/// All in one reference system: that of the points, else system_without_points (read_rasters.h).
using RunInput = CitySources;

/// Reads all, but for what is `given` in memory; points and rasters only where the domain may be,
/// by the headers and the footprints. Without points, a surface (`dsm`) becomes points, a point per
/// cell. Adds warnings. Throws Error(kInput): unusable files, degrees, units
/// other than metres, no overlap. Throws Error(kUsage) before it reads points if by the headers
/// they, or the mesh that is to follow, will not fit into memory.
RunInput read_input(const Config& config, Next next, StepClock& clock,
                    std::vector<Warning>& warnings, const InputInMemory& given = {});

}  // namespace tetropolis
