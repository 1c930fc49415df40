// Counting violations, keeping the first place of each kind.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/check/check_mesh.h"

namespace tetropolis {

/// Adds one violation of the kind `what`; `place()` is called for the first only.
template <typename Place>
void note_violation(std::vector<Violation>& violations, const char* what, const Place& place) {
  for (Violation& violation : violations) {
    if (violation.what != what) continue;
    ++violation.count;
    return;
  }
  violations.push_back({what, 1, place()});
}

}  // namespace tetropolis
