// City models as footprints. Private to src.
#pragma once

#include <filesystem>

#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// CityJSON, a CityJSON sequence or CityGML, by the first bytes.
bool is_city_model(const std::filesystem::path& path);

/// The buildings and parts of a city model (read_city): their outlines, the keys of their objects
/// as ids, as heights those of their roofs above their ground, and the roofs. Errors: those of
/// read_city; kUsage for options about attributes, which models do not have.
FootprintsInput read_model_footprints(const std::filesystem::path& path,
                                      const ReadFootprintsOptions& options);

}  // namespace tetropolis
