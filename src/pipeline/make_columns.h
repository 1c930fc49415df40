// Steps 3.2 to 3.5: from the ground mesh to the column mesh.
#pragma once

#include "tetropolis/city/city_model.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/report.h"
#include "tetropolis/terrain/raster.h"

#include "run/memory.h"
#include "run/step_clock.h"
#include "volume/column/fill_columns.h"

namespace tetropolis {

/// How `config` wants columns to be planned.
ColumnPlanOptions plan_options(const Config& config);

/// Valid columns, over terrain that is excavated nowhere. Fills the report's volume_mesh as far as
/// the columns are known by then, and its solver. Throws Error(kUsage) for a mesh that is too high
/// or too large, Error(kGuarantee) as require_valid.
Columns make_columns(const Config& config, const CityModel& city, const Raster& dtm,
                     const CitySize& size, GroundMesh ground, StepClock& clock, Report& report);

}  // namespace tetropolis
