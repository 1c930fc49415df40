// Hashes of places, for bringing equal ones together.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tetropolis {

/// The same for equal places; the bits of zeros with different signs are made equal.
inline std::uint64_t hash_of(const std::array<double, 3>& place) {
  std::uint64_t hash = 0;
  for (const double x : place) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 32;
  }
  return hash * 0x9e3779b97f4a7c15U >> 7;
}

}  // namespace tetropolis
