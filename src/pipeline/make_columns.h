// Steps 3.2 to 3.5: from the ground mesh to the column mesh.
#pragma once

#include "tetropolis/city/city_model.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/terrain/raster.h"

#include "city_parts.h"
#include "core/step_clock.h"
#include "memory.h"
#include "volume/column/fill_columns.h"

namespace tetropolis {

/// How `options` want columns to be planned.
ColumnPlanOptions plan_options(const MeshCityOptions& options);

/// Whether columns end at a lid over the city, above which the upper part has fewer and fewer:
/// graded ones below a flat top, unless their segments are bounded by layer_height.
inline bool ends_at_lid(const MeshCityOptions& options) {
  return !solves_laplace(options) && options.layer_height == 0;
}

/// Degrees that ground is cut back to for prisms (ease_ground).
double eased_slope(const MeshCityOptions& options);

/// Columns over terrain that is excavated nowhere; valid unless there are missed_buildings(). Fills
/// the volume facts of `result` as far as the columns are known by then, its solver and its
/// warnings. Throws Error(kUsage) for a mesh that is too high or too large.
Columns make_columns(const MeshCityOptions& options, const CityParts& parts, const Raster& dtm,
                     const CitySize& size, GroundMesh ground, StepClock& clock, CityMesh& result);

}  // namespace tetropolis
