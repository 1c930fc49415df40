// What a run says of its input before the work.
#pragma once

#include <string>

#include "tetropolis/pipeline/preflight.h"

#include "read_input.h"

namespace tetropolis {

/// "input: 52.0083 N, 4.3657 E (Netherlands), EPSG:28992; 14 points per m2, classes 1 2 6; ...".
std::string preflight_line(const Preflight& preflight, const RunInput& input);

}  // namespace tetropolis
