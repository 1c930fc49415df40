#include "tetropolis/core/progress.h"

#include <gtest/gtest.h>

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

TEST(Error, KindsAreExitCodes) {
  EXPECT_EQ(static_cast<int>(ErrorKind::kGuarantee), 1);
  EXPECT_EQ(static_cast<int>(ErrorKind::kUsage), 2);
  EXPECT_EQ(static_cast<int>(ErrorKind::kInput), 3);
  EXPECT_STREQ(Error(ErrorKind::kInput, "a.las: cut").what(), "a.las: cut");
}

}  // namespace
}  // namespace tetropolis
