// Lists of indices by their numbers.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis::testing {

template <typename I>
std::vector<I> indices_of(std::initializer_list<int> numbers) {
  return {numbers.begin(), numbers.end()};
}

template <std::size_t N>
std::vector<std::array<VertexIndex, N>> rows_of(std::initializer_list<std::array<int, N>> numbers) {
  std::vector<std::array<VertexIndex, N>> rows(numbers.size());
  std::size_t i = 0;
  for (const std::array<int, N>& row : numbers) {
    for (std::size_t k = 0; k < N; ++k) rows[i][k] = VertexIndex(row[k]);
    ++i;
  }
  return rows;
}

inline auto edges_of(std::initializer_list<std::array<int, 2>> numbers) {
  return rows_of<2>(numbers);
}
inline auto triangles_of(std::initializer_list<std::array<int, 3>> numbers) {
  return rows_of<3>(numbers);
}

}  // namespace tetropolis::testing
