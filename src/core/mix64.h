// A hash of 64 bits. Private to the library.
#pragma once

#include <cstdint>

namespace tetropolis {

/// One step of splitmix64: a well-mixed 64-bit hash of a counter. Source: Steele, Lea & Flood,
/// "Fast splittable pseudorandom number generators" (2014), with the constants of Stafford's
/// mix 13.
inline std::uint64_t mix64(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

}  // namespace tetropolis
