// Lengths are metres everywhere behind the readers.
#pragma once

#include <string>

namespace tetropolis {

/// Throws Error(kInput) naming `file` if coordinates in `crs` are degrees or not in metres; an
/// unknown system passes. `setting`, if any, is where the user could name the true system.
void require_metres(const std::string& crs, const std::string& file, const char* setting = nullptr);

/// Throws Error(kInput) naming `source` unless a unit of height is a metre. `setting` as above.
void require_heights_in_metres(double unit, const std::string& source, const char* setting);

}  // namespace tetropolis
