// The lines that `check` prints of what was found in one file.
#pragma once

#include <optional>
#include <string>

#include "tetropolis/check/check_city.h"
#include "tetropolis/check/check_results.h"
#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"

namespace tetropolis {

/// Facts and violations of a mesh, as those of the file `name`.
CheckedFile describe(const std::string& name, const VolumeCheck& check);
CheckedFile describe(const std::string& name, const SurfaceCheck& check);

/// The same of a city model; `min_distance`: the clearance that was asked for, if any, metres.
CheckedFile describe(const std::string& name, const CityCheck& check,
                     std::optional<double> min_distance);

/// The clearance of guarantee 2, and of the report: within the city and towards the domain's
/// boundary. Metres; infinity without buildings.
double joint_clearance_of(const CityCheck& check);

}  // namespace tetropolis
