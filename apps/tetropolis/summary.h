// What a run says when it is done.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/run/report.h"

namespace tetropolis::app {

/// Lines: what was built, how many features it accounts for, where it is, which file to open; then
/// notes; then counts and quality; then time and memory.
std::vector<std::string> summary(const Report& report);

}  // namespace tetropolis::app
