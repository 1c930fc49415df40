// Random numbers that are the same on every platform.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "tetropolis/geometry/types.h"

#include "core/mix64.h"

namespace tetropolis {

/// The top 53 bits as a number in [0, 1).
inline double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

/// A number in [0, 1) that belongs to a grid cell.
inline double cell_hash(std::uint64_t seed, std::int64_t i, std::int64_t j) {
  return unit_interval(
      mix64(mix64(seed ^ static_cast<std::uint64_t>(i)) + static_cast<std::uint64_t>(j)));
}

/// xoshiro256**, seeded by splitmix64. Source: Blackman & Vigna, "Scrambled linear pseudorandom
/// number generators" (2021).
class SeededRandom {
 public:
  /// Streams of one seed are independent sequences.
  SeededRandom(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t counter = mix64(seed) ^ mix64(~stream);
    for (std::uint64_t& word : state_) word = mix64(counter++);
  }

  std::uint64_t bits() {
    const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotate(state_[3], 45);
    return result;
  }

  /// In [0, 1).
  double unit() { return unit_interval(bits()); }
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  bool chance(double probability) { return unit() < probability; }

  /// Mean 0, standard deviation 1, within 3.5: the scaled sum of four uniform numbers.
  double bell() {
    double sum = unit();
    for (int k = 0; k < 3; ++k) sum += unit();
    return (sum - 2) * 1.7320508075688772;
  }

 private:
  static std::uint64_t rotate(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  std::array<std::uint64_t, 4> state_{};
};

/// The nearest whole millimetre; always the same double for the same millimetre.
inline double round_to_mm(double value) { return std::nearbyint(value * 1000) / 1000; }
inline Point2 on_mm(Point2 p) { return {round_to_mm(p.x), round_to_mm(p.y)}; }

}  // namespace tetropolis
