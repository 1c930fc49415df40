#include "ground/hilbert.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

// What makes it Hilbert's curve: every square of a power of two is passed through in one go, from
// each cell to one beside it.
TEST(Hilbert, PassesThroughSquaresFromCellToCell) {
  constexpr std::uint32_t kSide = 64;
  std::mt19937 engine(testing::test_seed());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> squares{{0, 0}, {1023, 1023}, {0, 1023}};
  for (int i = 0; i < 50; ++i) squares.emplace_back(engine() % 1024, engine() % 1024);
  for (const auto& [i, j] : squares) {
    std::uint32_t first = ~std::uint32_t{0};
    for (std::uint32_t x = 0; x < kSide; ++x)
      for (std::uint32_t y = 0; y < kSide; ++y)
        first = std::min(first, hilbert_index(i * kSide + x, j * kSide + y));
    EXPECT_EQ(first % (kSide * kSide), 0u);
    std::vector<std::pair<int, int>> cells(std::size_t{kSide} * kSide, {-1, -1});
    for (std::uint32_t x = 0; x < kSide; ++x) {
      for (std::uint32_t y = 0; y < kSide; ++y) {
        const std::uint32_t place = hilbert_index(i * kSide + x, j * kSide + y) - first;
        ASSERT_LT(place, cells.size());
        ASSERT_EQ(cells[place].first, -1) << "two cells at one place";
        cells[place] = {static_cast<int>(x), static_cast<int>(y)};
      }
    }
    for (std::size_t k = 1; k < cells.size(); ++k)
      ASSERT_EQ(std::abs(cells[k].first - cells[k - 1].first) +
                    std::abs(cells[k].second - cells[k - 1].second),
                1)
          << "square " << i << ", " << j << ", step " << k;
  }
}

// From the whole down: the first square of 2^15 cells comes before the others, and so on.
TEST(Hilbert, StartsAndEndsAtTheLowerCorners) {
  EXPECT_EQ(hilbert_index(0, 0), 0u);
  EXPECT_EQ(hilbert_index(65535, 0), ~std::uint32_t{0});
}

}  // namespace
}  // namespace tetropolis
