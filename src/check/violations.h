// Counting violations, keeping the first place of each kind.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/check/violation.h"

#include "core/parallel.h"

namespace tetropolis {

inline constexpr const char* kCoordinatesNotFinite = "coordinates that are not finite";

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

/// Calls look(begin, end, violations) for chunks of [0, size) in parallel and adds up what they
/// note in order.
template <typename Look>
std::vector<Violation> sum_of_violations(std::size_t size, const Look& look) {
  return parallel_reduce_ordered(
      size, 16384, std::vector<Violation>{},
      [&](std::size_t begin, std::size_t end) {
        std::vector<Violation> violations;
        look(begin, end, violations);
        return violations;
      },
      [](std::vector<Violation> sum, const std::vector<Violation>& part) {
        add_violations(sum, part);
        return sum;
      });
}

}  // namespace tetropolis
