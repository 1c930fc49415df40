#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "core/parallel_sort.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

TEST(Parallel, ChunksCoverTheRangeOnceInFixedPieces) {
  for (const std::size_t size : {0UL, 1UL, 7UL, 64UL, 1000UL})
    for (const std::size_t grain : {1UL, 7UL, 64UL, 5000UL}) {
      std::vector<int> visits(size, 0);
      std::atomic<bool> aligned = true;
      parallel_chunks(size, grain, [&](std::size_t begin, std::size_t end) {
        if (begin % grain != 0 || end > size || (end - begin != grain && end != size))
          aligned = false;
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_TRUE(aligned);
      EXPECT_EQ(visits, std::vector<int>(size, 1));
    }
}

TEST(Parallel, TheFirstFailureIsThrownWhateverTheThreads) {
  std::mt19937_64 random(testing::test_seed());
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<char> fails(100, 0);
    for (int k = 0; k < 4; ++k) fails[random() % fails.size()] = 1;
    const auto first = std::find(fails.begin(), fails.end(), 1) - fails.begin();
    const auto thrown = [&](const auto& loop) {
      try {
        loop();
      } catch (const std::runtime_error& error) {
        return std::string(error.what());
      }
      return std::string("nothing");
    };
    const auto job = [&](std::size_t i) {
      if (fails[i] != 0) throw std::runtime_error(std::to_string(i));
    };
    const ThreadLimit limit(1 + repeat % 8);
    EXPECT_EQ(thrown([&] { parallel_chunks(100, 1, [&](std::size_t b, std::size_t) { job(b); }); }),
              std::to_string(first));
    EXPECT_EQ(thrown([&] { parallel_in_order(100, job); }), std::to_string(first));
    EXPECT_EQ(thrown([&] { parallel_in_order(static_cast<std::size_t>(first), job); }), "nothing");
  }
}

TEST(Parallel, JobsInOrderRunOnceEach) {
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    std::vector<std::atomic<int>> runs(1000);
    std::atomic<std::size_t> most{0};
    parallel_in_order(runs.size(), [&](std::size_t i) {
      ++runs[i];
      if (threads == 1) {
        EXPECT_EQ(i, most++);
      }
    });
    EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](const auto& n) { return n == 1; }));
  }
}

TEST(Parallel, PipelineUsesInOrderWhatIsMadeInSlots) {
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    std::vector<std::string> slots(5);
    std::vector<std::size_t> used;
    std::atomic<int> busy{0};
    parallel_pipeline(
        1000, slots,
        [&](std::size_t i, std::string& slot) {
          slot = std::to_string(i);
          for (std::size_t k = 0; k < i % 7 * 100; ++k) slot.push_back('.');
        },
        [&](std::size_t i, const std::string& slot) {
          EXPECT_EQ(++busy, 1);
          EXPECT_EQ(std::stoul(slot), i) << "another item's slot";
          used.push_back(i);
          --busy;
        });
    std::vector<std::size_t> all(1000);
    std::iota(all.begin(), all.end(), std::size_t{0});
    EXPECT_EQ(used, all);
    parallel_pipeline(
        0, slots, [](std::size_t, std::string&) { ADD_FAILURE(); },
        [](std::size_t, const std::string&) { ADD_FAILURE(); });
  }
}

TEST(Parallel, PipelineThrowsTheFirstFailureAndUsesNothingBehindIt) {
  std::mt19937_64 random(testing::test_seed());
  for (int repeat = 0; repeat < 200; ++repeat) {
    const ThreadLimit limit(1 + repeat % 8);
    const std::size_t bad_make = random() % 100, bad_use = random() % 100;
    const std::size_t first = std::min(bad_make, bad_use);
    std::size_t used = 0;
    std::vector<int> slots(3);
    try {
      parallel_pipeline(
          100, slots,
          [&](std::size_t i, int&) {
            if (i == bad_make || i > 90) throw std::runtime_error("make " + std::to_string(i));
          },
          [&](std::size_t i, int) {
            if (i == bad_use) throw std::runtime_error("use " + std::to_string(i));
            ++used;
          });
      ADD_FAILURE() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), (first > 90            ? "make 91"
                               : bad_make <= bad_use ? "make " + std::to_string(first)
                                                     : "use " + std::to_string(first)));
    }
    EXPECT_EQ(used, std::min<std::size_t>(first, 91));
  }
}

TEST(Parallel, OrderedReductionHasTheSameBitsForAnyNumberOfThreads) {
  std::mt19937_64 random(testing::test_seed());
  std::vector<float> values(100000);
  for (float& value : values)
    value = static_cast<float>(static_cast<double>(random()) / 1e16 - 500);
  const auto sum = [&] {
    return parallel_reduce_ordered(
        values.size(), 77, 0.0F,
        [&](std::size_t begin, std::size_t end) {
          float part = 0;
          for (std::size_t i = begin; i < end; ++i) part += values[i];
          return part;
        },
        [](float a, float b) { return a + b; });
  };
  const float serial = [&] {
    const ThreadLimit limit(1);
    return sum();
  }();
  for (const int threads : {2, 3, 8}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(sum(), serial);
  }
}

TEST(Parallel, OrderedReductionOfTruthValuesLosesNone) {
  // One bit per chunk: were they to share bytes, threads would overwrite each other's.
  const ThreadLimit limit(8);
  constexpr std::size_t size = 20001;
  for (int repeat = 0; repeat < 50; ++repeat)
    EXPECT_TRUE(parallel_reduce_ordered(
        size, 1, false, [](std::size_t, std::size_t) { return true; },
        [](bool a, bool b) { return a != b; }));
  EXPECT_TRUE(parallel_reduce_ordered(
      size, 1, true, [](std::size_t, std::size_t) { return true; },
      [](bool a, bool b) { return a && b; }));
  EXPECT_FALSE(parallel_reduce_ordered(
      size, 1, true, [](std::size_t begin, std::size_t) { return begin != size - 1; },
      [](bool a, bool b) { return a && b; }));
}

TEST(Parallel, ThreadLimitHoldsWhileItLives) {
  const int before = thread_count();
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(thread_count(), 1);
  }
  EXPECT_EQ(thread_count(), before);
}

TEST(Parallel, ErrorsLeaveTheLoop) {
  EXPECT_THROW(parallel_chunks(1000, 10,
                               [](std::size_t begin, std::size_t) {
                                 if (begin == 500) throw std::runtime_error("x");
                               }),
               std::runtime_error);
}

TEST(Parallel, Sorts) {
  std::mt19937 random(testing::test_seed());
  std::vector<unsigned> values(50000);
  for (unsigned& value : values) value = static_cast<unsigned>(random());
  auto expected = values;
  std::sort(expected.begin(), expected.end());
  parallel_sort(values.begin(), values.end(), [](unsigned a, unsigned b) { return a < b; });
  EXPECT_EQ(values, expected);
}

}  // namespace
}  // namespace tetropolis
