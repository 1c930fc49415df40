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

/// Adds violations that were counted apart and come after those counted so far.
inline void add_violations(std::vector<Violation>& violations, const std::vector<Violation>& more) {
  for (const Violation& added : more) {
    std::size_t i = 0;
    while (i < violations.size() && violations[i].what != added.what) ++i;
    if (i < violations.size())
      violations[i].count += added.count;
    else
      violations.push_back(added);
  }
}

}  // namespace tetropolis
