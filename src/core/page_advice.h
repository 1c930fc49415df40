// What memory is for, told to the system, which may ignore it.
#pragma once

#include <cstddef>
#include <cstdint>

#include <sys/mman.h>
#include <unistd.h>

namespace tetropolis {

/// `advice` as of madvise(2), of the pages that are wholly in [begin, end).
inline void advise_pages(const void* begin, const void* end, int advice) {
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page;
  const auto last = reinterpret_cast<std::uintptr_t>(end) / page;
  if (first < last) madvise(reinterpret_cast<void*>(first * page), (last - first) * page, advice);
}

}  // namespace tetropolis
