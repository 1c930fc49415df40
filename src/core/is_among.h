// Whether a list holds a value. Private to the library.
#pragma once

#include <algorithm>
#include <iterator>

namespace tetropolis {

template <typename Value, typename List>
bool is_among(const Value& value, const List& list) {
  return std::find(std::begin(list), std::end(list), value) != std::end(list);
}

}  // namespace tetropolis
