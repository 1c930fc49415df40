// Steps 1.1 and 1.2: the files of a run.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/in_memory.h"

#include "core/step_clock.h"

namespace tetropolis {

/// What is to be made of a city.
enum class Next { kNothing, kMesh };

struct RunInput {
  PointsInput points;
  FootprintsInput footprints;  ///< In the reference system of the points.
};

/// Reads both, but for what is `given` in memory; points only where the domain may be, by the
/// headers and the footprints. Adds warnings. Throws Error(kInput): unusable files, degrees, units
/// other than metres, no overlap. Throws Error(kUsage) before it reads points if by the headers
/// they, or the mesh that is to follow, will not fit into memory.
RunInput read_input(const Config& config, Next next, StepClock& clock,
                    std::vector<Warning>& warnings, const InputInMemory& given = {});

}  // namespace tetropolis
