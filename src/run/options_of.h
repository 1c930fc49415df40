// The options of operations that the settings of a run stand for.
#pragma once

#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

BuildCityOptions city_options(const Config& config);

MeshCityOptions mesh_options(const Config& config);

}  // namespace tetropolis
