// A vector for large arrays that are written once, in any order.
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace tetropolis {

/// Leaves new elements without a value where none is given: memory that nothing has been written
/// to takes no room. Precondition: T may be copied byte by byte.
template <typename T>
struct RawAllocator : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = RawAllocator<U>;
  };
  template <typename U>
  void construct(U*) noexcept {}
  template <typename U, typename... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
};

/// resize() leaves new elements without a value.
template <typename T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace tetropolis
