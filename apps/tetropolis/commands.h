// The commands that only look at files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "console.h"

namespace tetropolis::app {

/// Prints on stdout what each file holds, and on stderr one line for each that cannot be read.
/// Returns whether all could.
bool info(const std::vector<std::string>& files);

/// Checks a city model, a volume, a boundary or a folder of results and prints what it found on
/// stdout (unless quiet: then only what is violated). Returns whether no guarantee is broken.
/// `min_distance`: clearance to ask of a city model; without it that of the report beside it, or 1
/// m. Throws Error for files that cannot be read.
bool check(const std::string& path, std::optional<double> min_distance, Console& console);

}  // namespace tetropolis::app
