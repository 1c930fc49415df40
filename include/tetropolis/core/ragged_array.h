// Rows of different lengths in one array: lists by building, items by cell, edges by vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetropolis {

/// Compressed rows (CSR): row r is values[offsets[r]] to values[offsets[r + 1] - 1].
template <typename Value, typename Offset = std::int64_t>
struct RaggedArray {
  std::vector<Offset> offsets{0};  ///< One more than there are rows, ascending from 0.
  std::vector<Value> values;       ///< Row after row; offsets.back() of them.

  /// The number of rows.
  std::size_t size() const { return offsets.size() - 1; }

  std::span<const Value> operator[](std::size_t row) const { return rows(row, row + 1); }
  std::span<Value> operator[](std::size_t row) {
    const auto begin = static_cast<std::size_t>(offsets[row]);
    return std::span(values).subspan(begin, static_cast<std::size_t>(offsets[row + 1]) - begin);
  }

  /// The rows from `first` to `last` - 1, one after the other.
  std::span<const Value> rows(std::size_t first, std::size_t last) const {
    const auto begin = static_cast<std::size_t>(offsets[first]);
    return std::span(values).subspan(begin, static_cast<std::size_t>(offsets[last]) - begin);
  }

  /// Appends a row.
  void push_back(std::span<const Value> row) {
    values.insert(values.end(), row.begin(), row.end());
    offsets.push_back(static_cast<Offset>(values.size()));
  }

  friend bool operator==(const RaggedArray&, const RaggedArray&) = default;
};

}  // namespace tetropolis
