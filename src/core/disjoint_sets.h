// Which of n things belong together (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace tetropolis {

/// Disjoint sets of the numbers 0 to size - 1; the root of a set is its lowest number.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::int32_t i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  bool joined(std::int32_t i, std::int32_t j) { return root(i) == root(j); }
  /// The lower number becomes the root.
  void join(std::int32_t i, std::int32_t j) {
    i = root(i);
    j = root(j);
    at(std::max(i, j)) = std::min(i, j);
  }

 private:
  std::int32_t& at(std::int32_t i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<std::int32_t> parent_;
};

}  // namespace tetropolis
