// The two halves of the pipeline that `build`, `city` and `mesh` share.
#pragma once

#include "tetropolis/city/city_model.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/terrain/raster.h"

#include "run/step_clock.h"

namespace tetropolis {

struct CityAndTerrain {
  CityModel city;
  Raster dtm;
};

/// What is to be made of a city.
enum class Next { kNothing, kMesh };

/// Steps 1.1 to 2.4: reads the input, writes city_raw.city.json, city.city.json and dtm.tif.
CityAndTerrain make_city(const Config& config, Next next, OutputFolder& out, StepClock& clock,
                         Report& report);

/// Steps 3.1 to 3.6: writes volume, boundary and surface. `city.domain` and `city.origin` are those
/// of the run.
void make_mesh(const Config& config, const CityModel& city, Raster dtm, OutputFolder& out,
               StepClock& clock, Report& report);

}  // namespace tetropolis
