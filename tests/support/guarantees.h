// Written results against every guarantee.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/check/check_results.h"

namespace tetropolis::testing {

/// Nothing is violated, and nothing is left unchecked but what contains `unchecked`, if that is not
/// empty.
inline void expect_guarantees(const std::filesystem::path& folder,
                              const std::string& unchecked = {}) {
  for (const CheckedFile& file : check_path(folder, std::nullopt)) {
    for (const Violation& violation : file.violations)
      ADD_FAILURE() << file.name << ": " << violation.what << " (" << violation.count << "), first "
                    << violation.first;
    for (const std::string& what : file.not_checked)
      if (unchecked.empty() || what.find(unchecked) == std::string::npos)
        ADD_FAILURE() << file.name << ": not checked: " << what;
  }
}

}  // namespace tetropolis::testing
