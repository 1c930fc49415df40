// Buildings to come, as the setting `planned` names them.
#pragma once

#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// Adds the features of all files of config.planned to `footprints`, with ids "planned:ID" (of
/// several files "planned:FILE:ID"), in the CRS of these. `options`: those that the footprints were
/// read with; attributes count where a plan has them, and source_crs where it states none. Throws
/// Error(kInput) as read_footprints, and for a feature without a height or below 0; Error(kUsage)
/// for entries that are neither FILE nor FILE:ATTRIBUTE.
void add_planned(const Config& config, const ReadFootprintsOptions& options,
                 FootprintsInput& footprints);

}  // namespace tetropolis
