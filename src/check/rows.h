// Items filed under rows, by counting: how the checks bring together what may belong together.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"

namespace tetropolis {

/// Row r holds numbers of items, ascending.
struct Rows {
  std::vector<std::int64_t> ends;  ///< Row r ends at ends[r] and begins where row r - 1 ends.
  std::vector<std::uint32_t> items;

  std::size_t size() const { return ends.size(); }
  std::span<const std::uint32_t> operator[](std::size_t r) const {
    const std::int64_t begin = r == 0 ? 0 : ends[r - 1];
    return std::span(items).subspan(static_cast<std::size_t>(begin),
                                    static_cast<std::size_t>(ends[r] - begin));
  }
};

/// Files each item i of [0, items) under every row r < rows for which rows_of(i, use) calls use(r).
/// Takes 8 bytes a row and 4 for each use. Throws Error(kInput) if there are 2^32 items.
template <typename RowsOf>
Rows file_under_rows(std::size_t items, std::size_t rows, const RowsOf& rows_of) {
  if (items > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kInput, "a mesh of more than 2^32 cells can only be checked in parts");
  constexpr std::size_t kGrain = 16384;
  Rows filed;
  filed.ends.assign(rows, 0);
  const auto end_of = [&](std::size_t r) { return std::atomic_ref(filed.ends[r]); };
  parallel_chunks(items, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      rows_of(i, [&](std::size_t r) { end_of(r).fetch_add(1, std::memory_order_relaxed); });
  });
  std::int64_t sum = 0;
  for (std::int64_t& count : filed.ends) {
    sum += count;
    count = sum;
  }
  filed.items.resize(static_cast<std::size_t>(sum));
  // Rows fill from their ends, which become their beginnings.
  parallel_chunks(items, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      rows_of(i, [&](std::size_t r) {
        const std::int64_t at = end_of(r).fetch_sub(1, std::memory_order_relaxed) - 1;
        filed.items[static_cast<std::size_t>(at)] = static_cast<std::uint32_t>(i);
      });
  });
  if (rows == 0) return filed;
  std::copy(filed.ends.begin() + 1, filed.ends.end(), filed.ends.begin());
  filed.ends.back() = sum;
  parallel_chunks(rows, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const auto first = filed.items.begin() + (r == 0 ? 0 : filed.ends[r - 1]);
      const auto last = filed.items.begin() + filed.ends[r];
      std::reverse(first, last);  // as one thread leaves them
      if (!std::is_sorted(first, last)) std::sort(first, last);
    }
  });
  return filed;
}

}  // namespace tetropolis
