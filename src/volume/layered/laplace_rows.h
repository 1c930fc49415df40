// Rows of a column as vectors.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "core/wide.h"

namespace tetropolis {

using Rows8 = float __attribute__((vector_size(32)));
using Rows4 = float __attribute__((vector_size(16)));

template <typename Rows>
TETROPOLIS_INLINE void load(Rows& rows, const float* from) {
  std::memcpy(&rows, from, sizeof(Rows));
}

/// Calls body(k, type) for rows [0, stride), up to eight at once; `type` has that of their vector.
/// Precondition: stride % 4 == 0.
template <typename Body>
TETROPOLIS_INLINE void over_rows(std::size_t stride, const Body& body) {
  std::size_t k = 0;
  for (; k + 8 <= stride; k += 8) body(k, std::type_identity<Rows8>{});
  if (k < stride) body(k, std::type_identity<Rows4>{});
}

/// to += weight * from. Precondition: stride % 4 == 0.
TETROPOLIS_INLINE void add_scaled(float* to, const float* from, float weight, std::size_t stride) {
  over_rows(
      stride, [&](std::size_t k, auto type) __attribute__((always_inline)) {
        typename decltype(type)::type sum, value;
        load(sum, to + k);
        load(value, from + k);
        sum += weight * value;
        std::memcpy(to + k, &sum, sizeof(sum));
      });
}

}  // namespace tetropolis
