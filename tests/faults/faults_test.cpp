// The real program when things go wrong around it: no room, no folder, no memory, signals, inputs
// that change. Nothing that looks like a result is left, one line says what happened, and an
// earlier result in the same folder is whole.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <set>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "program.h"
#include "support/sanitized.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::Ending;
using testing::Process;
using testing::ProcessLimits;
using testing::snapshot;
using testing::staging_folders;
using testing::wait_for_staging;
using Contents = std::map<std::string, std::string>;

class Faults : public ::testing::Test {
 protected:
  /// A small city, made once, open to everybody.
  static void SetUpTestSuite() {
    shared = std::make_unique<testing::TemporaryFolder>();
    fs::permissions(shared->path(), fs::perms(0755));
    const Ending made = Process(shared->path(), command({"synth", "--quiet", "--kind", "blocks",
                                                         "--size", "300", "--out", "input"}))
                            .wait();
    ASSERT_EQ(made.code, 0) << made.err;
  }
  static void TearDownTestSuite() { shared.reset(); }

  void SetUp() override {
    fs::permissions(scratch.path(), fs::perms(0755));
    fs::create_directory(work);
    fs::permissions(work, fs::perms(0777));
    fs::create_directory(scratch / "input");
    for (const auto& entry : fs::directory_iterator(shared->path() / "input"))
      fs::copy_file(entry.path(), scratch / "input" / entry.path().filename());
  }

  void TearDown() override {
    std::error_code ignored;
    fs::permissions(work, fs::perms(0777), ignored);
    fs::permissions(work / "result", fs::perms(0777), ignored);
  }

  static std::vector<std::string> command(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), TETROPOLIS_PROGRAM);
    return arguments;
  }

  Ending run(const std::vector<std::string>& arguments, const ProcessLimits& limits = {}) {
    return Process(work, command(arguments), limits).wait();
  }

  /// build into work/result, or `out`.
  std::vector<std::string> build(const std::vector<std::string>& more = {},
                                 const std::string& out = "result") {
    std::vector<std::string> arguments{"build",        "--quiet",
                                       "--footprints", (scratch / "input/footprints.shp").string(),
                                       "--points",     (scratch / "input/points.laz").string(),
                                       "--out",        out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// Those of somebody who is not root, who may read the input.
  ProcessLimits unprivileged() {
    fs::permissions(scratch / "input", fs::perms(0755));
    ProcessLimits limits;
    limits.unprivileged = true;
    return limits;
  }

  /// An earlier result of other settings, and a file of the user beside it.
  Contents make_earlier(const ProcessLimits& limits = {}) {
    const Ending made = run(build({"--mesh-size", "20", "--formats", "vtu,openfoam"}), limits);
    EXPECT_EQ(made.code, 0) << made.err;
    std::ofstream(work / "result/notes.txt") << "mine";
    return snapshot(work);
  }

  static void expect_one_line(const Ending& ending) {
    EXPECT_EQ(std::count(ending.err.begin(), ending.err.end(), '\n'), 1) << ending.err;
    EXPECT_TRUE(ending.err.starts_with("tetropolis: ")) << ending.err;
    EXPECT_EQ(ending.err.find("please report"), std::string::npos) << ending.err;
    EXPECT_EQ(ending.err.find("std::"), std::string::npos) << ending.err;
  }

  /// A run that failed with `code`: one line, no trace, everything in work/ as it was.
  void expect_nothing_new(const Ending& ending, int code, const Contents& before) {
    EXPECT_EQ(ending.code, code) << ending.err;
    expect_one_line(ending);
    EXPECT_TRUE(snapshot(work) == before);
    EXPECT_TRUE(staging_folders(work).empty());
  }

  /// No test of speed: a grace that is too long, or a run that is not ended at all but comes to its
  /// end, cannot be told from a good one otherwise. The program promises about a second.
  static void expect_ended_at_once(const Ending& ending) {
    EXPECT_LT(ending.after_signal.count(), TETROPOLIS_SANITIZED ? 20 : 5) << ending.err;
  }

  /// A build that gets the signal once it has ended so many steps, or a moment later.
  Ending signalled(int steps, int number, std::mt19937& random, const std::string& out) {
    const fs::path log = scratch / "log";
    fs::remove(log);
    Process process(work, command(build({"--mesh-size", "5", "--log", log.string()}, out)));
    while (!process.ended() && lines_of(log) < steps)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    // The first moments are for the hidden folder.
    if (steps == 0) wait_for_staging(work, process);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20000));
    process.signal(number);
    Ending ending = process.wait();
    expect_ended_at_once(ending);
    return ending;
  }

  /// Runs the program by a script that mounts something, where nobody else sees it.
  Ending run_in_own_mounts(const std::string& script, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{
        "/usr/bin/unshare", geteuid() == 0 ? "-m" : "-Urm", "/bin/sh", "-c", script, "sh",
        TETROPOLIS_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Process(work, words).wait();
  }

  /// Why there can be no mounts of our own, or nothing.
  std::string no_mounts() {
    const Ending ending = run_in_own_mounts("mount -t tmpfs -o size=64k tmpfs . && true", {});
    return ending.code == 0 ? "" : "no mount of our own here: " + ending.err;
  }

  static int lines_of(const fs::path& path) {
    std::ifstream file(path);
    return static_cast<int>(std::count(std::istreambuf_iterator<char>(file), {}, '\n'));
  }

  /// The signal came after the end: then there is a whole result, now the earlier one.
  Contents accept_whole(bool fresh) {
    EXPECT_EQ(run({"check", fresh ? "fresh" : "result"}).code, 0);
    if (fresh) fs::remove_all(work / "fresh");
    return snapshot(work);
  }

  static constexpr int kSteps = 17;  // lines of the log before the last step ends
  static inline std::unique_ptr<testing::TemporaryFolder> shared;
  testing::TemporaryFolder scratch;
  fs::path work = scratch / "work";
};

const std::vector<std::string> kAllFormats{"--mesh-size", "20", "--formats",
                                           "vtu,xdmf,msh,openfoam,obj,ply,glb"};

/// The sizes of everything a run writes, each one less a byte: one file after the other fails.
TEST_F(Faults, FilesThatMayNotGrowFailOneAfterTheOther) {
  ASSERT_EQ(run(build(kAllFormats, "whole")).code, 0);
  std::set<std::uintmax_t> sizes{1, 4096};
  for (const auto& entry : fs::recursive_directory_iterator(work / "whole"))
    if (entry.is_regular_file()) sizes.insert(entry.file_size());
  fs::remove_all(work / "whole");
  const Contents before = make_earlier();
  for (const std::uintmax_t size : sizes) {
    SCOPED_TRACE("files of at most " + std::to_string(size - 1) + " bytes");
    ProcessLimits limits;
    limits.file_size = size - 1;
    const Ending ending = run(build(kAllFormats), limits);
    expect_nothing_new(ending, 3, before);
    EXPECT_NE(ending.err.find("result"), std::string::npos) << ending.err;
  }
}

/// LASzip tells of a stream that fails which of its functions it was in.
TEST_F(Faults, PointsThatCannotBeWrittenAreToldWithTheSystemsReason) {
  ProcessLimits limits;
  limits.file_size = 100'000;
  const Ending ending = run({"synth", "--quiet", "--size", "300", "--out", "result"}, limits);
  expect_nothing_new(ending, 3, {});
  EXPECT_NE(ending.err.find("points.laz: File too large"), std::string::npos) << ending.err;
}

TEST_F(Faults, FilesThatMayNotBeReadAreNamed) {
  const ProcessLimits limits = unprivileged();
  if (run({"--version"}, limits).code != 0) GTEST_SKIP() << "the program cannot be run by others";
  for (const char* member : {"footprints.dbf", "footprints.shx", "footprints.prj"}) {
    const fs::path path = scratch / "input" / member;
    fs::permissions(path, fs::perms::none);
    const Ending ending = run(build(), limits);
    fs::permissions(path, fs::perms(0644));
    expect_nothing_new(ending, 3, {});
    EXPECT_NE(ending.err.find(std::string(member) + ": cannot be read: Permission denied"),
              std::string::npos)
        << ending.err;
  }
  make_earlier(limits);
  fs::permissions(work / "result/report.json", fs::perms::none);
  const Ending checked = run({"check", "result", "--quiet"}, limits);
  fs::permissions(work / "result/report.json", fs::perms(0644));
  EXPECT_EQ(checked.code, 3);
  EXPECT_NE(checked.err.find("report.json: cannot be read: Permission denied"), std::string::npos)
      << checked.err;
}

TEST_F(Faults, FullDiskLeavesNothingAndSaysSo) {
  // A small disk in a name space of its own; its content is listed from inside.
  const std::string script =
      "mount -t tmpfs -o size=SIZE tmpfs . && cd \"$PWD\" || exit 77; "
      "if [ SIZE = 1m ]; then mkdir result; echo old >result/report.json; fi; "
      "\"$@\"; code=$?; find . -mindepth 1 | sort >&2; cat result/report.json >&2 2>/dev/null; "
      "exit $code";
  if (const std::string reason = no_mounts(); !reason.empty()) GTEST_SKIP() << reason;
  for (const std::string size : {"64k", "1m", "3m"}) {
    SCOPED_TRACE(size);
    std::string sized = script;
    for (std::size_t at; (at = sized.find("SIZE")) != std::string::npos;)
      sized.replace(at, 4, size);
    const Ending ending =
        run_in_own_mounts(sized, build({"--mesh-size", "4", "--formats",
                                        "vtu,xdmf,msh,openfoam,obj,ply,glb", "--overwrite"}));
    EXPECT_EQ(ending.code, 3) << ending.err;
    const std::size_t line = ending.err.find('\n');
    EXPECT_NE(ending.err.substr(0, line).find("No space left"), std::string::npos) << ending.err;
    EXPECT_EQ(ending.err.substr(line + 1),
              size == "1m" ? "./result\n./result/report.json\nold\n" : "");
  }
}

TEST_F(Faults, FolderRemovedDuringTheRun) {
  for (const int delay : {0, 30, 100}) {
    SCOPED_TRACE(delay);
    fs::create_directory(work / "deep");
    Process process(work, command(build({"--mesh-size", "2"}, "deep/result")));
    ASSERT_TRUE(wait_for_staging(work / "deep", process));
    std::this_thread::sleep_for(std::chrono::milliseconds(delay));
    std::error_code ignored;
    while (fs::exists(work / "deep") && !process.ended()) fs::remove_all(work / "deep", ignored);
    const Ending ending = process.wait();
    // Gone before the hidden folder was locked, it is a folder that cannot be written: 2.
    expect_nothing_new(ending, ending.code == 2 ? 2 : 3, {});
    EXPECT_NE(ending.err.find("deep"), std::string::npos) << ending.err;
  }
}

TEST_F(Faults, FolderMadeReadOnlyDuringTheRun) {
  const ProcessLimits limits = unprivileged();
  if (run({"--version"}, limits).code != 0) GTEST_SKIP() << "the program cannot be run by others";
  const Contents before = make_earlier(limits);
  {
    // The folder of the earlier result: it stays as it is.
    Process process(work, command(build({"--mesh-size", "4"})), limits);
    ASSERT_TRUE(wait_for_staging(work, process));
    fs::permissions(work / "result", fs::perms(0555));
    const Ending ending = process.wait();
    fs::permissions(work / "result", fs::perms(0777));
    // Read-only before the run has begun to write, it is a folder that cannot be written: 2.
    expect_nothing_new(ending, ending.code == 2 ? 2 : 3, before);
    EXPECT_NE(ending.err.find("Permission denied"), std::string::npos) << ending.err;
  }
  {
    // The folder around: even the hidden folder cannot be removed, but it is emptied.
    Process process(work, command(build({"--mesh-size", "4"}, "other")), limits);
    ASSERT_TRUE(wait_for_staging(work, process));
    fs::permissions(work, fs::perms(0555));
    const Ending ending = process.wait();
    fs::permissions(work, fs::perms(0777));
    EXPECT_TRUE(ending.code == 3 || ending.code == 2) << ending.code << ending.err;
    expect_one_line(ending);
    EXPECT_TRUE(snapshot(work) == before);
    for (const fs::path& folder : staging_folders(work)) EXPECT_TRUE(fs::is_empty(folder));
  }
}

TEST_F(Faults, InterruptsInEveryStepLeaveTheEarlierResult) {
  Contents before = make_earlier();
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  int interrupted = 0;
  for (int step = 0; step < kSteps; ++step) {
    SCOPED_TRACE("after " + std::to_string(step) + " steps");
    const int number = std::array{SIGTERM, SIGINT, SIGHUP}[static_cast<std::size_t>(step % 3)];
    const bool fresh = step % 2 == 0;
    const Ending ending = signalled(step, number, random, fresh ? "fresh" : "result");
    if (ending.code == 0) {
      before = accept_whole(fresh);
      continue;
    }
    ++interrupted;
    expect_nothing_new(ending, 130, before);
    EXPECT_EQ(ending.err, "tetropolis: interrupted; nothing was written\n");
  }
  EXPECT_GT(interrupted, kSteps / 2);
}

TEST_F(Faults, ResultFolderInAFolderThatTakesNothing) {
  const ProcessLimits limits = unprivileged();
  if (run({"--version"}, limits).code != 0) GTEST_SKIP() << "the program cannot be run by others";
  make_earlier(limits);
  fs::permissions(work, fs::perms(0555));
  const Ending ending = run(build(), limits);
  const Ending failed = run(build({"--points", "nowhere.laz"}), limits);
  fs::permissions(work, fs::perms(0777));
  EXPECT_EQ(ending.code, 0) << ending.err;
  EXPECT_EQ(run({"check", "result"}).code, 0);
  EXPECT_EQ(failed.code, 3);
  EXPECT_TRUE(staging_folders(work).empty());
  EXPECT_TRUE(staging_folders(work / "result").empty());
}

TEST_F(Faults, ResultFolderThatIsAMount) {
  const std::string script =
      "mkdir result && mount -t tmpfs -o size=60m tmpfs result || exit 77; \"$@\" || exit; ls -A "
      "result | tr '\\n' ' ' >&2";
  if (const std::string reason = no_mounts(); !reason.empty()) GTEST_SKIP() << reason;
  const Ending ending = run_in_own_mounts(script, build({"--mesh-size", "20"}));
  EXPECT_EQ(ending.code, 0) << ending.err;
  EXPECT_EQ(ending.err,
            "boundary.vtp buildings.gpkg city.city.json city_raw.city.json dtm.tif index.html "
            "report.json "
            "surface.stl surface.vtp volume.vtu ");
}

TEST_F(Faults, InterruptEndsAStepThatWaitsForEver) {
  const Contents before = make_earlier();
  // An ordinary file that has GDAL wait for another.
  const fs::path never = scratch / "never.vrt", pipe = scratch / "pipe.tif";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0666), 0);
  std::ofstream(never) << "<VRTDataset rasterXSize=\"10\" rasterYSize=\"10\">"
                          "<GeoTransform>0, 1, 0, 10, 0, -1</GeoTransform>"
                          "<VRTRasterBand dataType=\"Float64\" band=\"1\"><SimpleSource>"
                          "<SourceFilename>"
                       << pipe.string()
                       << "</SourceFilename><SourceBand>1</SourceBand>"
                          "</SimpleSource></VRTRasterBand></VRTDataset>";
  for (const int signals : {1, 2}) {
    Process process(work, command({"mesh", "--quiet", "--city", "result/city.city.json", "--dtm",
                                   never.string(), "--out", "result"}));
    ASSERT_TRUE(wait_for_staging(work, process));
    // The folder is there a moment before the program says what to remove.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    for (int i = 0; i < signals; ++i) process.signal(SIGINT);
    const Ending ending = process.wait();
    expect_nothing_new(ending, 130, before);
    expect_ended_at_once(ending);
  }
}

TEST_F(Faults, InterruptEndsARunThatWaitsForAnotherToReplaceItsResults) {
  const Contents before = make_earlier();
  const int folder = ::open((work / "result").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_GE(folder, 0);
  ASSERT_EQ(::flock(folder, LOCK_EX), 0);
  for (const int signals : {1, 2}) {
    Process process(work, command(build({"--mesh-size", "30"})));
    const auto is_done = [&] {
      const auto staging = staging_folders(work);
      return !staging.empty() && fs::exists(staging[0] / "report.json");
    };
    while (!is_done() && !process.ended())
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_FALSE(process.ended());
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    for (int i = 0; i < signals; ++i) process.signal(SIGINT);
    const Ending ending = process.wait();
    expect_nothing_new(ending, 130, before);
    expect_ended_at_once(ending);
  }
  ::close(folder);
}

TEST_F(Faults, KillsInEveryStepLeaveTheEarlierResultAndTheNextRunTidiesUp) {
  Contents before = make_earlier();
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed + 1);
  int killed = 0;
  for (int step = 0; step < kSteps; ++step) {
    SCOPED_TRACE("after " + std::to_string(step) + " steps");
    const bool fresh = step % 2 == 1;
    const Ending ending = signalled(step, SIGKILL, random, fresh ? "fresh" : "result");
    if (ending.code == 0) {
      before = accept_whole(fresh);
      continue;
    }
    ++killed;
    // Hidden folders may be there, one a target; nothing else is.
    EXPECT_EQ(ending.code, 128 + SIGKILL);
    EXPECT_TRUE(snapshot(work) == before);
    EXPECT_LE(staging_folders(work).size(), 2U);
  }
  EXPECT_GT(killed, kSteps / 2);
  ASSERT_EQ(run(build()).code, 0);
  ASSERT_EQ(run(build({}, "fresh")).code, 0);
  EXPECT_TRUE(staging_folders(work).empty());
  EXPECT_EQ(run({"check", "result"}).code, 0);
}

TEST_F(Faults, RunsIntoOneFolderLeaveEachOtherAlone) {
  Process slow(work, command(build({"--mesh-size", "3"})));
  ASSERT_TRUE(wait_for_staging(work, slow));
  const Ending quick = run(build({"--mesh-size", "20"}));
  EXPECT_EQ(quick.code, 0) << quick.err;
  const Ending ending = slow.wait();
  EXPECT_EQ(ending.code, 0) << ending.err;
  EXPECT_TRUE(staging_folders(work).empty());
  EXPECT_EQ(run({"check", "result"}).code, 0);
}

TEST_F(Faults, TooLittleMemoryIsSaidInOneLine) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "sanitizers reserve address space of their own";
  const Contents before = make_earlier();
  int failed = 0;
  for (const int megabytes : {220, 260, 300, 350, 400, 500}) {
    SCOPED_TRACE(std::to_string(megabytes) + " MB of address space");
    ProcessLimits limits;
    limits.address_space = static_cast<rlim_t>(megabytes) << 20;
    const Ending ending =
        run(build({"--mesh-size", "1.5", "--threads", "2", "--max-memory", "1T"}), limits);
    if (ending.code == 0) break;
    ++failed;
    // Inside the decoder of points it cannot be told from a broken file: 3.
    expect_nothing_new(ending, ending.code == 3 ? 3 : 1, before);
    EXPECT_NE(ending.err.find("memory"), std::string::npos) << ending.err;
  }
  EXPECT_GT(failed, 0);
}

/// What is advised is something that the command has an option for.
TEST_F(Faults, TooLittleMemoryForACityIsNoMatterOfTheMeshSize) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "sanitizers reserve address space of their own";
  int failed = 0;
  for (int megabytes = 210; megabytes < 400; megabytes += 10) {
    SCOPED_TRACE(std::to_string(megabytes) + " MB of address space");
    ProcessLimits limits;
    limits.address_space = static_cast<rlim_t>(megabytes) << 20;
    const Ending ending = run({"synth", "--quiet", "--buildings", "100", "--size", "1500",
                               "--point-density", "1", "--threads", "1", "--out", "result"},
                              limits);
    if (ending.code == 0) break;
    if (ending.err.find("out of memory; ") == std::string::npos) continue;
    ++failed;
    EXPECT_EQ(ending.code, 1);
    EXPECT_EQ(ending.err.find("--mesh-size"), std::string::npos) << ending.err;
  }
  EXPECT_GT(failed, 0);
}

// The JSON library ends the program where it finds no memory to free what it has read.
TEST_F(Faults, EndsWithoutMemorySayWhy) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "sanitizers reserve address space of their own";
  {
    std::ofstream file(work / "report.json");
    file << R"({"version": "0", "command": "x", "warnings": [)";
    for (int i = 0; i < 3'000'000; ++i) file << R"({"code":"a"},)";
    file << "{}]}";
  }
  ProcessLimits limits;
  limits.address_space = static_cast<rlim_t>(260) << 20;
  const Ending ending = run({"info", "report.json"}, limits);
  EXPECT_EQ(ending.code, 1);
  expect_one_line(ending);
  EXPECT_NE(ending.err.find("out of memory"), std::string::npos) << ending.err;
}

// Less than the libraries need to begin: GDAL aborts the program, threads cannot be made.
TEST_F(Faults, LibrariesWithoutMemoryDoNotCrashTheProgram) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "sanitizers reserve address space of their own";
  const Contents before = make_earlier();
  int refused = 0;
  for (int megabytes = 140; megabytes < 230; megabytes += 3) {
    SCOPED_TRACE(std::to_string(megabytes) + " MB of address space");
    ProcessLimits limits;
    limits.address_space = static_cast<rlim_t>(megabytes) << 20;
    const Ending ending = run(build({"--mesh-size", "20"}), limits);
    if (ending.code == 0) break;
    // Not even loaded, or a library crashed before the program began.
    if (ending.code == 127 || (ending.code > 128 && run({"--version"}, limits).code > 128))
      continue;
    ++refused;
    EXPECT_TRUE(ending.code >= 1 && ending.code <= 3) << ending.code;
    // Libraries may have said something of their own before.
    const std::size_t last = ending.err.rfind('\n', ending.err.size() - 2) + 1;
    EXPECT_TRUE(ending.err.substr(last).starts_with("tetropolis: ")) << ending.err;
    EXPECT_TRUE(snapshot(work) == before);
  }
  EXPECT_GT(refused, 0);
  // Without memory to remove a hidden folder, it is left to the next run.
  EXPECT_EQ(run(build({"--mesh-size", "20"})).code, 0);
  EXPECT_TRUE(staging_folders(work).empty());
}

TEST_F(Faults, PointFileThatShrinksWhileItIsRead) {
  // Enough points for the file to be cut while they are read.
  ASSERT_EQ(run({"synth", "--quiet", "--buildings", "20", "--size", "300", "--point-density", "10",
                 "--out", (scratch / "input").string()})
                .code,
            0);
  const fs::path points = scratch / "input/points.laz";
  const fs::path copy = scratch / "copy.laz";
  fs::copy_file(points, copy);
  const std::uintmax_t size = fs::file_size(points);
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed + 2);
  int failed = 0;
  for (int round = 0; round < 8; ++round) {
    fs::copy_file(copy, points, fs::copy_options::overwrite_existing);
    std::vector<std::string> city = build({"--threads", "1"}, "fresh");
    city[0] = "city";
    Process process(work, command(city));
    ASSERT_TRUE(wait_for_staging(work, process));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
    fs::resize_file(points, size * (random() % 90) / 100);
    const Ending ending = process.wait();
    if (ending.code == 0) {
      EXPECT_EQ(run({"check", "fresh"}).code, 0);
      fs::remove_all(work / "fresh");
      continue;
    }
    ++failed;
    expect_nothing_new(ending, 3, {});
    EXPECT_NE(ending.err.find("points.laz"), std::string::npos) << ending.err;
  }
  EXPECT_GT(failed, 0);
}

TEST_F(Faults, OneUnreadableFileAmongFiveHundredIsNamed) {
  const fs::path tiles = scratch / "tiles";
  fs::create_directory(tiles);
  fs::copy_file(scratch / "input/points.laz", tiles / "tile_000.laz");
  for (int i = 1; i < 500; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "tile_%03d.laz", i);
    fs::create_hard_link(tiles / "tile_000.laz", tiles / name);
  }
  const fs::path bad = tiles / "tile_317.laz";
  std::vector<std::string> arguments = build();
  *(std::find(arguments.begin(), arguments.end(), "--points") + 1) = tiles.string();
  const auto expect_named = [&](const ProcessLimits& limits, const char* reason) {
    const Ending ending = run(arguments, limits);
    expect_nothing_new(ending, 3, {});
    EXPECT_NE(ending.err.find("tile_317.laz"), std::string::npos) << ending.err;
    EXPECT_NE(ending.err.find(reason), std::string::npos) << ending.err;
  };
  fs::remove(bad);
  std::ofstream(bad) << "LASF but no more";
  expect_named({}, "cut");
  fs::remove(bad);
  fs::create_symlink("nowhere", bad);
  expect_named({}, "tile_317");
  fs::remove(bad);
  fs::copy_file(tiles / "tile_000.laz", bad);
  fs::permissions(bad, fs::perms(0));
  const ProcessLimits limits = unprivileged();
  if (run({"--version"}, limits).code == 0) expect_named(limits, "Permission denied");
}

TEST_F(Faults, ACloudThatCrashesTheDecoderIsABrokenFile) {
  const Contents before = make_earlier();
  const fs::path cloud = scratch / "input/points.laz";
  fs::copy_file(fs::path(TETROPOLIS_FUZZ_FOLDER) / "known/laszip_recursion_ends_the_stack.laz",
                cloud, fs::copy_options::overwrite_existing);
  const Ending ending = run({"city", "--terrain-only", "--quiet", "--points", cloud.string(),
                             "--out", "result", "--points-crs", "EPSG:3006"});
  expect_nothing_new(ending, 3, before);
  EXPECT_NE(ending.err.find(cloud.string() + ": a library crashed on it"), std::string::npos)
      << ending.err;
}

}  // namespace
}  // namespace tetropolis
