// What commands make before they write it. Private to src/run.
#pragma once

#include "tetropolis/core/steps.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/in_memory.h"
#include "tetropolis/run/report.h"
#include "tetropolis/run/run.h"

#include "read_input.h"

namespace tetropolis {

/// Steps 1.1 to 2.3, with heights of vegetation if asked for. Fills the report.
BuiltCity make_city(const Config& config, Next next, const InputInMemory& given,
                    const RunHooks& hooks, Report& report, bool canopy_heights);

/// The input of `tetropolis mesh`. Fills the report; `raw` is empty.
BuiltCity load_city(const Config& config, const StepHooks& hooks, Report& report);

/// Steps 3.1 to 3.5. Fills the report, with places in the CRS.
CityMesh make_mesh(const Config& config, const CityModel& city, Raster terrain,
                   const Raster& canopy_heights, const StepHooks& hooks, Report& report);

}  // namespace tetropolis
