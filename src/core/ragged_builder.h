// Ragged arrays from (row, value) pairs in any order, by counting. Private to the library.
#pragma once

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tetropolis/core/error.h"
#include "tetropolis/core/ragged_array.h"

#include "parallel.h"

namespace tetropolis {

/// Two passes over the same pairs: count() all, start(), place() all, take(). Rows keep the order
/// of place(). Needs no memory beside the result.
template <typename Value, typename Offset = std::int64_t>
class RaggedBuilder {
 public:
  explicit RaggedBuilder(std::size_t rows) { array_.offsets.assign(rows + 2, 0); }

  void count(std::size_t row) { ++array_.offsets[row + 2]; }

  /// Room for what was counted. From here on offsets[row + 1] is where the row's next value goes.
  void start() {
    std::vector<Offset>& offsets = array_.offsets;
    for (std::size_t i = 2; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
    array_.values.resize(static_cast<std::size_t>(offsets.back()));
  }

  void place(std::size_t row, Value value) {
    array_.values[static_cast<std::size_t>(array_.offsets[row + 1]++)] = std::move(value);
  }

  /// Precondition: all that was counted was placed. The builder is spent.
  RaggedArray<Value, Offset> take() {
    array_.offsets.pop_back();
    assert(static_cast<std::size_t>(array_.offsets.back()) == array_.values.size());
    return std::move(array_);
  }

 private:
  RaggedArray<Value, Offset> array_;
};

/// Every pair for which for_each(use) calls use(row, value). It is called twice and has to give the
/// same pairs in the same order, which rows keep.
template <typename Value, typename Offset = std::int64_t, typename ForEach>
RaggedArray<Value, Offset> ragged_from_pairs(std::size_t rows, const ForEach& for_each) {
  RaggedBuilder<Value, Offset> builder(rows);
  for_each([&](std::size_t row, const Value&) { builder.count(row); });
  builder.start();
  for_each([&](std::size_t row, const Value& value) { builder.place(row, value); });
  return builder.take();
}

/// One row for each list.
template <typename Value>
RaggedArray<Value> ragged_from_lists(const std::vector<std::vector<Value>>& lists) {
  RaggedArray<Value> array;
  for (const std::vector<Value>& list : lists) array.push_back(list);
  return array;
}

/// Files each item i of [0, items) under every row r < rows for which rows_of(i, use) calls use(r),
/// in parallel; rows are ascending. Takes 8 bytes a row and 4 for each use. Throws Error(kInput) if
/// there are 2^32 items.
template <typename RowsOf>
RaggedArray<std::uint32_t> file_under_rows(std::size_t items, std::size_t rows,
                                           const RowsOf& rows_of) {
  if (items > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kInput, "a mesh of more than 2^32 cells can only be checked in parts");
  constexpr std::size_t kGrain = 16384;
  RaggedArray<std::uint32_t> filed;
  filed.offsets.assign(rows + 1, 0);
  const auto end_of = [&](std::size_t r) { return std::atomic_ref(filed.offsets[r + 1]); };
  parallel_chunks(items, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      rows_of(i, [&](std::size_t r) { end_of(r).fetch_add(1, std::memory_order_relaxed); });
  });
  std::int64_t sum = 0;
  for (std::int64_t& count : filed.offsets) count = sum += count;
  filed.values.resize(static_cast<std::size_t>(sum));
  // Rows fill from their ends, which become their beginnings.
  parallel_chunks(items, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      rows_of(i, [&](std::size_t r) {
        const std::int64_t at = end_of(r).fetch_sub(1, std::memory_order_relaxed) - 1;
        filed.values[static_cast<std::size_t>(at)] = static_cast<std::uint32_t>(i);
      });
  });
  std::copy(filed.offsets.begin() + 1, filed.offsets.end(), filed.offsets.begin());
  filed.offsets.back() = sum;
  parallel_chunks(rows, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const std::span<std::uint32_t> row = filed[r];
      std::reverse(row.begin(), row.end());  // as one thread leaves them
      if (!std::is_sorted(row.begin(), row.end())) std::sort(row.begin(), row.end());
    }
  });
  return filed;
}

}  // namespace tetropolis
