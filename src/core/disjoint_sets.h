// Which of n things belong together (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace tetropolis {

/// Disjoint sets of the indices from 0 to size - 1; the root of a set is its lowest one.
template <typename I>
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), I(0));
  }
  I root(I i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  bool joined(I i, I j) { return root(i) == root(j); }
  /// The lower number becomes the root.
  void join(I i, I j) {
    i = root(i);
    j = root(j);
    at(std::max(i, j)) = std::min(i, j);
  }

 private:
  I& at(I i) { return parent_[i]; }
  std::vector<I> parent_;
};

}  // namespace tetropolis
