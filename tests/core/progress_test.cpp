#include "tetropolis/core/progress.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"

#include "core/parallel.h"
#include "core/shared_progress.h"

namespace tetropolis {
namespace {

TEST(Progress, ReportsAndStops) {
  double seen = -1;
  bool stop = false;
  const Progress progress{[&](double fraction) { seen = fraction; }, [&] { return stop; }};
  progress.update(0.25);
  EXPECT_EQ(seen, 0.25);
  stop = true;
  EXPECT_THROW(progress.update(0.5), Cancelled);
  EXPECT_EQ(seen, 0.25);
}

TEST(Progress, MayBeEmpty) { EXPECT_NO_THROW(Progress{}.update(1)); }

/// A progress that notes what is reported.
Progress noting(std::vector<double>& seen) {
  return {[&](double fraction) { seen.push_back(fraction); }, {}};
}

TEST(Progress, PortionsMapAllToAPartOfTheWhole) {
  std::vector<double> seen;
  const Progress whole = noting(seen);
  const Progress part = portion(whole, 0.25, 0.75);
  for (const double fraction : {0.0, 0.5, 1.0}) part.update(fraction);
  EXPECT_EQ(seen, (std::vector{0.25, 0.5, 0.75}));
  // A part of the part.
  seen.clear();
  const Progress inner = portion(part, 0.5, 1);
  for (const double fraction : {0.0, 0.5, 1.0}) inner.update(fraction);
  EXPECT_EQ(seen, (std::vector{0.5, 0.625, 0.75}));
}

TEST(Progress, PortionsEndWhereTheNextBeginsWhateverIsReported) {
  std::vector<double> seen;
  const Progress whole = noting(seen);
  const Progress first = portion(whole, 0, 0.25), second = portion(whole, 0.25, 1);
  // Work that turns out to be more than was thought.
  for (const double fraction : {0.0, 0.3, 0.9, 1.0, 1.1, 7.0}) first.update(fraction);
  for (const double fraction : {0.0, 0.3, 0.9, 1.0, 1.1, 7.0}) second.update(fraction);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen[5], 0.25);
  EXPECT_EQ(seen.back(), 1);
}

TEST(Progress, PortionsStopWithTheWholeAndMayBeEmpty) {
  bool stop = false;
  Progress whole;
  EXPECT_NO_THROW(portion(whole, 0.2, 0.4).update(0.5));
  EXPECT_FALSE(portion(whole, 0.2, 0.4).report);  // callers may ask whether anyone listens
  whole.cancelled = [&] { return stop; };
  const Progress part = portion(whole, 0.2, 0.4);
  EXPECT_NO_THROW(part.update(0.5));
  stop = true;
  EXPECT_THROW(part.update(0.5), Cancelled);
}

TEST(Progress, SharedProgressAddsUpWhatIsDone) {
  std::vector<double> seen;
  const Progress progress = noting(seen);
  SharedProgress shared(progress, 8);
  for (const std::int64_t done : {2, 0, 1, 5}) shared.add(done);
  EXPECT_EQ(seen, (std::vector{0.25, 0.25, 0.375, 1.0}));
  // Of nothing, all is done.
  SharedProgress nothing(progress, 0);
  nothing.add(0);
  EXPECT_EQ(seen.back(), 1);
}

TEST(Progress, SharedProgressOfThreadsLosesNothingAndNeverGoesBack) {
  constexpr std::size_t size = 2000;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    std::vector<double> seen;
    std::atomic<int> busy{0};
    Progress progress;
    progress.report = [&](double fraction) {
      ASSERT_EQ(++busy, 1) << "reports at the same time";
      std::this_thread::yield();  // so that others come, if they can
      seen.push_back(fraction);
      --busy;
    };
    SharedProgress shared(progress, static_cast<std::int64_t>(size));
    parallel_chunks(size, 1, [&](std::size_t, std::size_t) { shared.add(1); });
    // Every count once, in order.
    std::vector<double> all;
    for (std::size_t i = 1; i <= size; ++i)
      all.push_back(static_cast<double>(i) / static_cast<double>(size));
    EXPECT_EQ(seen, all);
  }
}

TEST(Progress, SharedProgressStopsAParallelLoop) {
  const ThreadLimit limit(4);
  std::atomic<int> polls{0};
  Progress progress;
  progress.cancelled = [&] { return ++polls >= 100; };
  SharedProgress shared(progress, 100'000);
  std::atomic<int> done{0};
  EXPECT_THROW(parallel_chunks(100'000, 1,
                               [&](std::size_t, std::size_t) {
                                 shared.add(1);
                                 ++done;
                               }),
               Cancelled);
  EXPECT_EQ(done, 99);
}

TEST(Error, OneLineHasSpacesForControlCharacters) {
  for (int byte = 0; byte < 256; ++byte) {
    // What ends lines, moves the cursor or rings; UTF-8 begins and continues above 127.
    const bool control = byte < 32 || byte == 127;
    const std::string text = std::string("a") + static_cast<char>(byte) + "b";
    EXPECT_EQ(one_line(text), control ? "a b" : text) << byte;
  }
  EXPECT_EQ(one_line("one\r\ntwo\n"), "one  two ");
}

TEST(Error, MessagesAreOneLineWhateverTheyQuote) {
  EXPECT_STREQ(Error(ErrorKind::kInput, "a\nb.las: \x1b[31mcut").what(), "a b.las:  [31mcut");
  EXPECT_EQ(Error(ErrorKind::kUsage, "").kind(), ErrorKind::kUsage);
}

TEST(Error, KindsAreExitCodes) {
  EXPECT_EQ(static_cast<int>(ErrorKind::kGuarantee), 1);
  EXPECT_EQ(static_cast<int>(ErrorKind::kUsage), 2);
  EXPECT_EQ(static_cast<int>(ErrorKind::kInput), 3);
  EXPECT_STREQ(Error(ErrorKind::kInput, "a.las: cut").what(), "a.las: cut");
}

}  // namespace
}  // namespace tetropolis
