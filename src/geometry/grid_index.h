// Items filed under the squares of a grid that they cover.
#pragma once

#include <cstddef>
#include <cstdint>

#include "tetropolis/geometry/types.h"

#include "core/ragged_builder.h"
#include "square_grid.h"

namespace tetropolis {

struct GridIndex {
  SquareGrid grid;
  RaggedArray<std::uint32_t> rows;  ///< One for each square.
};

/// Files each item i of [0, items) under every square for which cover(grid, i, use) calls
/// use(square). There are about as many squares over `box` as items, and fewer where items would
/// cover many: memory grows with the number of items, whatever they are like.
template <typename Cover>
GridIndex index_on_grid(std::size_t items, const Bounds2& box, const Cover& cover) {
  constexpr std::size_t kMostUses = 16;  // of an item, on average
  for (std::size_t wanted = items;; wanted /= 4) {
    const SquareGrid grid(box, wanted);
    std::size_t uses = 0;
    for (std::size_t i = 0; i < items && uses <= kMostUses * items; ++i)
      cover(grid, i, [&](std::size_t) { ++uses; });
    if (wanted == 0 || uses <= kMostUses * items)
      return {grid, file_under_rows(items, grid.size(),
                                    [&](std::size_t i, const auto& use) { cover(grid, i, use); })};
  }
}

}  // namespace tetropolis
