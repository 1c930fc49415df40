// A commit that is killed at any of its moves: what is there is the earlier result, the new one, or
// no result at all that the next run makes the earlier one again.
#include <csignal>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tetropolis/run/output_folder.h"

#include "program.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::put;
using testing::snapshot;
using testing::staging_folders;
using Contents = std::map<std::string, std::string>;

bool is_rename(std::uint64_t number) {
#ifdef SYS_rename
  if (number == SYS_rename) return true;
#endif
#ifdef SYS_renameat
  if (number == SYS_renameat) return true;
#endif
  return number == SYS_renameat2;
}

enum class Fate { kEnded, kKilled, kUntraceable };

/// Runs `action` in a process of its own that is killed as it enters its rename number `fatal`.
template <typename Action>
Fate run_until_rename(int fatal, const Action& action) {
  const pid_t child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(77);
    raise(SIGSTOP);
    action();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFSTOPPED(status)) return Fate::kUntraceable;
  ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  for (int seen = 0;;) {
    ptrace(PTRACE_SYSCALL, child, nullptr, 0);
    waitpid(child, &status, 0);
    if (WIFEXITED(status)) return Fate::kEnded;
    if (WIFSIGNALED(status)) return Fate::kKilled;
    if (WSTOPSIG(status) != (SIGTRAP | 0x80)) continue;
    __ptrace_syscall_info info{};
    if (ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info) <= 0) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return Fate::kUntraceable;
    }
    if (info.op == PTRACE_SYSCALL_INFO_ENTRY && is_rename(info.entry.nr) && ++seen == fatal)
      kill(child, SIGKILL);
  }
}

void make_earlier(const fs::path& result) {
  for (const char* name :
       {"dtm.tif", "volume.vtu", "boundary.vtp", "constant/polyMesh/points", "surface.ply"})
    put(result / name, "old");
  put(result / "report.json", R"({"version": "0", "command": "build",
      "steps": [], "files": ["dtm.tif", "volume.vtu", "boundary.vtp", "constant/polyMesh/points",
      "surface.ply"]})");
  put(result / "notes.txt", "mine");
  put(result / "constant/g", "mine");
}

/// A run that makes some names again, one anew, and leaves some away. It may replace files of
/// others.
void write_and_commit(const fs::path& result) {
  OutputFolder out(result, {}, Replaces::kAll, true);
  for (const char* name :
       {"volume.vtu", "boundary.vtp", "report.json", "constant/polyMesh/points", "volume.msh"})
    put(out / name, "new");
  out.commit();
}

/// Kills a commit into a folder that `make` fills at each of its moves. Returns how many there are
/// and at how many of them the folder was left torn.
template <typename Make>
std::pair<int, int> kill_at_every_move(const Make& make) {
  const auto whole = [&] {
    const testing::TemporaryFolder scratch;
    make(scratch / "result");
    write_and_commit(scratch / "result");
    return snapshot(scratch.path());
  };
  const Contents after = whole();
  EXPECT_EQ(after.at("result/volume.msh"), "new");
  EXPECT_FALSE(after.contains("result/dtm.tif"));
  int torn = 0, fatal = 1;
  for (;; ++fatal) {
    SCOPED_TRACE("killed at rename " + std::to_string(fatal));
    const testing::TemporaryFolder scratch;
    make(scratch / "result");
    const Contents before = snapshot(scratch.path());
    const Fate fate = run_until_rename(fatal, [&] { write_and_commit(scratch / "result"); });
    if (fate == Fate::kUntraceable) return {0, 0};
    if (fate == Fate::kEnded) {
      EXPECT_TRUE(snapshot(scratch.path()) == after);
      EXPECT_TRUE(staging_folders(scratch.path()).empty());
      break;
    }
    const Contents left = snapshot(scratch.path());
    for (const auto& [name, text] : before) {
      if (text == "mine") {
        EXPECT_EQ(left.at(name), "mine");
      }
    }
    if (left != before && left != after) {
      ++torn;
      EXPECT_FALSE(left.contains("result/report.json"))
          << "a report beside what it does not describe";
    }
    // The next run gives up before its end: what it found torn is the earlier result again. Killed
    // in the middle of that, it is so one run later.
    for (int again = 1; again < 40; ++again) {
      const Fate next =
          run_until_rename(again, [&] { const OutputFolder unused(scratch / "result"); });
      if (next == Fate::kEnded) break;
    }
    EXPECT_TRUE(snapshot(scratch.path()) == before);
    EXPECT_TRUE(staging_folders(scratch.path()).empty());
  }
  return {fatal, torn};
}

TEST(KilledCommit, IsAllOrNothingAtEveryMove) {
  const auto [moves, torn] = kill_at_every_move(make_earlier);
  if (moves == 0) GTEST_SKIP() << "processes cannot be traced here";
  EXPECT_GT(moves, 10);
  EXPECT_GT(torn, 5);
}

/// Files of the user's that have names of results: those that no result replaces stay.
void make_foreign(const fs::path& result) {
  put(result / "report.json", "of another program");
  put(result / "volume.vtu", "old");
  fs::create_symlink("notes.txt", result / "boundary.vtp");
  put(result / "surface.ply", "mine");
}

TEST(KilledCommit, FilesOfOthersStay) {
  const auto [moves, torn] = kill_at_every_move(make_foreign);
  if (moves == 0) GTEST_SKIP() << "processes cannot be traced here";
  EXPECT_GT(torn, 3);
}

TEST(KilledCommit, IntoAFolderWithoutResultsLeavesItAsItWas) {
  const auto [moves, torn] =
      kill_at_every_move([](const fs::path& result) { put(result / "notes.txt", "mine"); });
  if (moves == 0) GTEST_SKIP() << "processes cannot be traced here";
  EXPECT_GT(moves, 5);
  EXPECT_GT(torn, 3);
  kill_at_every_move([](const fs::path& result) { fs::create_directory(result); });
}

TEST(KilledCommit, HiddenFoldersOfOthersStay) {
  const testing::TemporaryFolder scratch;
  const OutputFolder other(scratch / "result");
  put(other / "dtm.tif", "being made");
  put(scratch / ".result.part-notours", "a file");
  put(scratch / ".result.part-toolongname/x", "x");
  put(scratch / ".results.part-abcdef/x", "x");
  put(scratch / ".result.part-abcdef/dtm.tif", "of a killed run");
  fs::create_directory_symlink(scratch / ".results.part-abcdef", scratch / ".result.part-linked");
  { const OutputFolder mine(scratch / "result"); }
  EXPECT_TRUE(fs::exists(other / "dtm.tif"));
  EXPECT_TRUE(fs::exists(scratch / ".result.part-notours"));
  EXPECT_TRUE(fs::exists(scratch / ".result.part-toolongname/x"));
  EXPECT_TRUE(fs::exists(scratch / ".results.part-abcdef/x"));
  EXPECT_TRUE(fs::is_symlink(scratch / ".result.part-linked"));
  EXPECT_FALSE(fs::exists(scratch / ".result.part-abcdef"));
}

}  // namespace
}  // namespace tetropolis
