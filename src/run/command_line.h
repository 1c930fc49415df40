// The command line that a run was started with, or would have been.
#pragma once

#include <string>

#include "tetropolis/run/config.h"

namespace tetropolis {

/// "tetropolis build --footprints ...": the settings that differ from their defaults, as a POSIX
/// shell reads them. Paths stay as they were given: relative to the folder it was started in.
std::string command_line(const Config& config, const std::string& command);

}  // namespace tetropolis
