// How much memory a run may use.
#pragma once

#include <string>

#include "tetropolis/run/config.h"

namespace tetropolis {

/// Bytes the process may take: `max_memory`, or nine tenths of what the machine, the control groups
/// and the limits of the process leave it (usable_memory). Throws Error(kUsage) if the setting is
/// no size.
double memory_limit(const Config& config);

/// Bytes of "8G" or "500M". Throws Error(kUsage): not a size, or less than a megabyte.
double parse_size(const std::string& text);

}  // namespace tetropolis
