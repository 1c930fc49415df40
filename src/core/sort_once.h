// Sorted lists without duplicates. Private to src.
#pragma once

#include <algorithm>
#include <vector>

namespace tetropolis {

/// Sorts, and keeps one of those that are equal.
template <typename Value>
void sort_once(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace tetropolis
