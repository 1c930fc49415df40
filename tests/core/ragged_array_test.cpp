#include "tetropolis/core/ragged_array.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "core/ragged_builder.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

template <typename Value, typename Offset>
std::vector<std::vector<Value>> lists_of(const RaggedArray<Value, Offset>& array) {
  std::vector<std::vector<Value>> lists;
  for (std::size_t r = 0; r < array.size(); ++r)
    lists.emplace_back(array[r].begin(), array[r].end());
  return lists;
}

TEST(RaggedArray, HasNoRowsAtFirstAndGrowsByRows) {
  RaggedArray<int> array;
  EXPECT_EQ(array.size(), 0u);
  array.push_back(std::vector<int>{7, 8});
  array.push_back({});
  array.push_back(std::vector<int>{9});
  EXPECT_EQ(array.size(), 3u);
  EXPECT_EQ(array.offsets, (std::vector<std::int64_t>{0, 2, 2, 3}));
  EXPECT_EQ(lists_of(array), (std::vector<std::vector<int>>{{7, 8}, {}, {9}}));
  const std::span<const int> all = array.rows(0, 3), last = array.rows(1, 3);
  EXPECT_EQ(std::vector<int>(all.begin(), all.end()), array.values);
  EXPECT_EQ(std::vector<int>(last.begin(), last.end()), std::vector<int>{9});
  array[0][1] = 5;
  EXPECT_EQ(array.values, (std::vector<int>{7, 5, 9}));
}

TEST(RaggedArray, BuildersGiveTheListsOfVectors) {
  std::mt19937 random(test_seed());
  for (const std::size_t rows : {0UL, 1UL, 50UL}) {
    std::vector<std::pair<std::size_t, int>> pairs(rows == 0 ? 0 : 1000);
    std::vector<std::vector<int>> expected(rows);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      // The first and the last row are empty where there are others.
      const std::size_t row = rows == 1 ? 0 : 1 + random() % (rows - 2);
      pairs[i] = {row, static_cast<int>(i)};
      expected[row].push_back(static_cast<int>(i));
    }
    const auto array = ragged_from_pairs<int, std::uint32_t>(rows, [&](const auto& use) {
      for (const auto& [row, value] : pairs) use(row, value);
    });
    EXPECT_EQ(array.size(), rows);
    EXPECT_EQ(lists_of(array), expected);
    EXPECT_EQ(lists_of(ragged_from_lists(expected)), expected);
  }
}

TEST(RaggedArray, FiledInParallelRowsAreAscendingForAnyNumberOfThreads) {
  constexpr std::size_t kItems = 100'000, kRows = 777;
  const auto file = [&](int threads) {
    const ThreadLimit limit(threads);
    return file_under_rows(kItems, kRows, [&](std::size_t i, const auto& use) {
      use(i * 31 % kRows);
      if (i % 3 == 0) use(i * i % kRows);
    });
  };
  std::vector<std::vector<std::uint32_t>> expected(kRows);
  for (std::uint32_t i = 0; i < kItems; ++i) {
    const std::size_t item = i;
    expected[item * 31 % kRows].push_back(i);
    if (i % 3 == 0) expected[item * item % kRows].push_back(i);
  }
  EXPECT_EQ(lists_of(file(1)), expected);
  EXPECT_EQ(file(1), file(4));
  EXPECT_EQ(file_under_rows(0, 0, [](std::size_t, const auto&) {}).size(), 0u);
}

}  // namespace
}  // namespace tetropolis
