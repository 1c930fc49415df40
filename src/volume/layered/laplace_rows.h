// Rows of a column as vectors.
#pragma once

#include <cstddef>
#include <cstring>

#include "core/wide.h"

namespace tetropolis {

using Rows8 = float __attribute__((vector_size(32)));
using Rows4 = float __attribute__((vector_size(16)));

template <typename Rows>
TETROPOLIS_INLINE void load(Rows& rows, const float* from) {
  std::memcpy(&rows, from, sizeof(Rows));
}

template <typename Rows>
TETROPOLIS_INLINE void add_scaled_rows(float* to, const float* from, float weight) {
  Rows sum, value;
  load(sum, to);
  load(value, from);
  sum += weight * value;
  std::memcpy(to, &sum, sizeof(sum));
}

/// to += weight * from. Precondition: stride % 4 == 0.
TETROPOLIS_INLINE void add_scaled(float* to, const float* from, float weight, std::size_t stride) {
  std::size_t k = 0;
  for (; k + 8 <= stride; k += 8) add_scaled_rows<Rows8>(to + k, from + k, weight);
  if (k < stride) add_scaled_rows<Rows4>(to + k, from + k, weight);
}

}  // namespace tetropolis
