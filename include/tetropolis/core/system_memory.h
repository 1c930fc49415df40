// How much memory this process may use.
#pragma once

#include <cstdint>

namespace tetropolis {

/// Bytes: the least of the machine's memory, the limits of the process's control groups
/// (containers, batch systems) and its limit of address space (ulimit -v).
double usable_memory();

/// Bytes of address space that the process may still take under its limit (ulimit -v); infinity
/// without one.
double address_space_left();

/// Largest resident memory that this program has had so far.
std::int64_t peak_rss_bytes();

}  // namespace tetropolis
