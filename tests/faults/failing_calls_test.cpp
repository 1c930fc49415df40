// Single calls of the system that fail: what is said of it is true, and what is there is whole or
// can be made so.
#include "failing_calls.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/run.h"

#include "io/file/atomic_file.h"
#include "program.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::Call;
using testing::FailingCalls;
using testing::snapshot;
using testing::staging_folders;

constexpr int kForGood = std::numeric_limits<int>::max();

/// What a commit into `result` says when its rename number `first` fails, and all others up to
/// `last`; empty if it has fewer. `staging` becomes its hidden folder.
std::string failed_commit(const fs::path& result, int first, int last, fs::path& staging) {
  OutputFolder out(result);
  staging = staging_folders(result.parent_path()).at(0);
  for (const char* name :
       {"volume.vtu", "boundary.vtp", "report.json", "constant/polyMesh/points", "volume.msh"})
    testing::put(out / name, "new");
  const FailingCalls failing(Call::kRename, first, last, EROFS);
  try {
    out.commit();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_NE(std::string(error.what()).find(std::strerror(EROFS)), std::string::npos);
    return error.what();
  }
  return "";
}

TEST(FailingCalls, MovesThatFailAreUndoneOrTheMessageSaysWhereTheEarlierResultIs) {
  for (const char* earlier : {"volume.vtu", "constant/polyMesh/points", "constant/g"})
    for (const bool for_good : {false, true}) {
      int torn = 0, undone = 0;
      for (int first = 1;; ++first) {
        SCOPED_TRACE(std::string(earlier) + ", rename " + std::to_string(first) +
                     (for_good ? " and all that follow" : ""));
        const testing::TemporaryFolder scratch;
        const fs::path result = scratch / "result";
        for (const char* name : {"dtm.tif", "boundary.vtp", earlier})
          testing::put(result / name, "old");
        testing::put(result / "report.json",
                     R"({"version": "0", "command": "build", "steps": [],
                "files": ["dtm.tif", "boundary.vtp", ")" +
                         std::string(earlier) + R"("]})");
        testing::put(result / "notes.txt", "mine");
        const auto before = snapshot(scratch.path());
        fs::path staging;
        const std::string message =
            failed_commit(result, first, for_good ? kForGood : first, staging);
        if (message.empty()) break;
        if (message.ends_with("; the earlier result is unchanged")) {
          ++undone;
          EXPECT_TRUE(staging_folders(scratch.path()).empty());
        } else {
          ++torn;
          EXPECT_TRUE(message.ends_with("; part of the earlier result is in " + staging.string() +
                                        ": keep that, the next run with this `out` puts it back"))
              << message;
          EXPECT_TRUE(fs::exists(staging));
          EXPECT_FALSE(snapshot(scratch.path()) == before);
          { const OutputFolder next(result); }
        }
        EXPECT_TRUE(snapshot(scratch.path()) == before);
        if (HasFailure()) return;
      }
      if (for_good) {
        EXPECT_EQ(undone, 1) << "only the first has nothing to undo";
        EXPECT_GT(torn, 5);
      } else {
        EXPECT_EQ(torn, 0);
        EXPECT_GT(undone, 5);
      }
    }
}

TEST(FailingCalls, AWriteThatFailsIsToldWithItsReason) {
  int failures = 0;
  for (int number = 1;; ++number) {
    SCOPED_TRACE(number);
    const testing::TemporaryFolder scratch;
    const FailingCalls failing(Call::kWrite, number, number, ENOSPC);
    try {
      AtomicFile file(scratch / "volume.vtu");
      file.write("a head that stays in the buffer");
      file.overwrite(2, "tail");
      file.write(std::string(100000, 'x'));
      file.overwrite(7, "that");
      file.stream() << "by a library";  // that does not ask whether it worked
      file.stream().seekp(0);
      file.stream() << "A";
      file.commit();
    } catch (const Error& error) {
      ++failures;
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      EXPECT_EQ(std::string(error.what()), "cannot write " + (scratch / "volume.vtu").string() +
                                               ": " + std::strerror(ENOSPC) +
                                               "; choose another output or free disk space");
      EXPECT_TRUE(fs::is_empty(scratch.path()));
      EXPECT_EQ(failing.failed(), 1);
      continue;
    }
    EXPECT_EQ(failing.failed(), 0);
    break;
  }
  EXPECT_GE(failures, 5);
}

TEST(FailingCalls, AHiddenFolderThatStaysIsTold) {
  const testing::TemporaryFolder scratch;
  Config config;
  config.out = (scratch / "city").string();
  config.size = 60;
  config.buildings = 2;
  const auto told = [](const Report& report) {
    std::vector<std::string> messages;
    for (const Warning& warning : report.warnings)
      if (warning.code == "hidden_folder_left") messages.push_back(warning.message);
    return messages;
  };
  EXPECT_TRUE(told(run_synth(config)).empty());
  config.seed = 2;
  {
    const FailingCalls failing(Call::kUnlinkat, 1, kForGood, EIO);
    const auto messages = told(run_synth(config));
    EXPECT_GT(failing.failed(), 0);
    const auto left = staging_folders(scratch.path());
    ASSERT_EQ(left.size(), 1U);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0], left[0].string() + ": cannot be removed: " + std::strerror(EIO) +
                               "; the results are complete without it, remove it");
  }
  auto second = snapshot(scratch / "city");
  config.out = (scratch / "other").string();
  run_synth(config);
  auto alone = snapshot(scratch / "other");
  for (auto* files : {&second, &alone}) EXPECT_EQ(files->erase("report.json"), 1U);
  EXPECT_TRUE(second == alone);
  config.out = (scratch / "city").string();
  EXPECT_TRUE(told(run_synth(config)).empty());
  EXPECT_TRUE(staging_folders(scratch.path()).empty());
}

}  // namespace
}  // namespace tetropolis
