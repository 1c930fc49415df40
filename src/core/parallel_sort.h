// Sorting on several threads. Private to the library.
#pragma once

#ifdef TETROPOLIS_PLAIN_THREADS
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace tetropolis {

/// Sorts [begin, end) by a strict total order `less` (ties would make the order depend on threads).
template <typename Iterator, typename Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
#ifdef TETROPOLIS_PLAIN_THREADS
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace tetropolis
