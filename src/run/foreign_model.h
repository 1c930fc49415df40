// City models of other programs, which are simplified before they can be meshed.
#pragma once

#include <optional>

#include "tetropolis/run/config.h"

namespace tetropolis {

/// Settings of `build` that make of `mesh`'s what can be meshed, the model's outlines, heights
/// and roofs being the footprints: where no terrain is given (nor lies beside a model of ours as
/// dtm.tif, which is then set as `config.dtm`), and where the outlines of another program's model
/// are closer than min_building_distance or otherwise cannot be meshed as they are. None: the model
/// can be meshed. Throws as read_city does.
std::optional<Config> as_footprints(Config& config);

}  // namespace tetropolis
