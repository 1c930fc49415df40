// A table that knows by which indices it is read.
#pragma once

#include <concepts>
#include <cstddef>
#include <vector>

#include "tetropolis/core/index.h"

namespace tetropolis {

/// A std::vector that takes its own kind of Index (and plain integers) in [], and no other kind.
template <typename I, typename T>
class IndexedVector : public std::vector<T> {
 public:
  using std::vector<T>::vector;
  using std::vector<T>::operator=;
  using std::vector<T>::operator[];
  template <typename Tag, typename Number>
  requires(!std::same_as<Index<Tag, Number>, I>) void operator[](Index<Tag, Number>) const = delete;

  /// Of all elements.
  IndexRange<I> indices() const { return tetropolis::indices<I>(this->size()); }
  /// Of the element that is appended next.
  I next() const { return I(this->size()); }
};

}  // namespace tetropolis
