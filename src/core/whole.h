// The floor of numbers in loops over many. Private to the library.
#pragma once

namespace tetropolis {

/// The greatest whole number up to `x`; of numbers beyond 2^51, one near it. Unlike std::floor,
/// which is a call on plain x86-64, it leaves loops to be vectorised (given -fno-trapping-math).
inline double whole(double x) {
  constexpr double kNoFractions = 6755399441055744.0;  // 1.5 * 2^52
  const double nearest = (x + kNoFractions) - kNoFractions;
  const double below = nearest - 1;
  return nearest > x ? below : nearest;
}

}  // namespace tetropolis
