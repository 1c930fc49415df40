// The options of operations that the settings of a run stand for.
#pragma once

#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// What `domain` says: "data", "auto", "cylinder", or a file with a polygon.
DomainShape domain_shape(const Config& config);

/// Without the polygon of a domain, which is in a file.
BuildCityOptions city_options(const Config& config);

MeshCityOptions mesh_options(const Config& config);

}  // namespace tetropolis
