// The median. Private to the library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tetropolis {

/// The upper one of two; reorders the values, of which there must be some.
template <typename Number>
Number median(std::vector<Number>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace tetropolis
