// Counts of work done by this process: allocations, calls of the exact predicates, calls of GEOS.
//
// operator new is replaced for the whole executable; the other functions are intercepted by the
// linker (--wrap, see CMakeLists.txt), which needs the library to be static. Counting takes the
// calls of all threads.
#pragma once

#include <cstdint>

namespace tetropolis::testing {

struct Counts {
  std::int64_t allocations = 0;      ///< Calls of operator new.
  std::int64_t allocated_bytes = 0;  ///< By them, in all.
  std::int64_t peak_bytes = 0;       ///< Most of them at one time, beyond those there at the start.
  std::int64_t exact_orientations = 0;  ///< Calls of orient2d that its filter could not decide.
  std::int64_t exact_circles = 0;       ///< The same of incircle.
  std::int64_t geos_operations = 0;     ///< Unions, differences, intersections, repairs, checks.
};

/// Sets all counts to zero.
void start_counting();

/// Counts since then.
Counts counts();

}  // namespace tetropolis::testing
