// What a user sees on a terminal: a bar while the run goes on, and nothing of it afterwards.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "program.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::Ending;
using testing::Process;

/// What stands on a terminal after it was sent `bytes`: lines, the last one as it was left. It
/// knows "\r", "\n" and "\033[K", which clears from the cursor to the end of the line.
std::vector<std::string> shown(const std::string& bytes) {
  std::vector<std::string> lines{""};
  std::size_t column = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string& line = lines.back();
    if (bytes.compare(i, 3, "\033[K") == 0) {
      line.resize(std::min(line.size(), column));
      i += 2;
    } else if (bytes[i] == '\r') {
      column = 0;
    } else if (bytes[i] == '\n') {
      lines.emplace_back();
      column = 0;
    } else {
      line.resize(std::max(line.size(), column + 1), ' ');
      line[column++] = bytes[i];
    }
  }
  return lines;
}

/// With N for what is measured: seconds, megabytes, and when an earlier run was.
std::string without_measures(const std::string& line) {
  return std::regex_replace(std::regex_replace(line, std::regex(" +[0-9.]+ (s|MB)"), " N $1"),
                            std::regex("run of [-0-9: ]+"), "run of N");
}

class Terminal : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::has_terminals()) GTEST_SKIP() << "no terminals here";
    const Ending made =
        run({"synth", "--quiet", "--kind", "blocks", "--size", "300", "--out", "in"});
    ASSERT_EQ(made.code, 0) << made.err;
  }

  Process start(std::vector<std::string> arguments, bool terminal) const {
    arguments.insert(arguments.begin(), TETROPOLIS_PROGRAM);
    return {folder.path(), arguments, {.terminal = terminal}};
  }
  Ending run(const std::vector<std::string>& arguments, bool terminal = false) const {
    return start(arguments, terminal).wait();
  }
  static std::vector<std::string> build(const std::string& out) {
    return {"build",    "--footprints",  "in/footprints.shp",
            "--points", "in/points.laz", "--out",
            out,        "--mesh-size",   "4"};
  }

  testing::TemporaryFolder folder;
};

TEST_F(Terminal, ShowsABarWhileItRunsAndLeavesTheLinesOfAPipe) {
  ASSERT_EQ(run(build("result")).code, 0);  // which the others replace
  for (const char* more : {"--quiet=false", "--verbose"}) {
    SCOPED_TRACE(more);
    std::vector<std::string> arguments = build("result");
    arguments.emplace_back(more);
    const Ending piped = run(arguments);
    const Ending seen = run(arguments, true);
    ASSERT_EQ(piped.code, 0) << piped.err;
    ASSERT_EQ(seen.code, 0) << seen.err;
    EXPECT_EQ(piped.err.find('\r'), std::string::npos);
    EXPECT_FALSE(std::regex_search(piped.err, std::regex("[0-9] %, "))) << piped.err;
    EXPECT_GT(std::count(seen.err.begin(), seen.err.end(), '%'), 20);
    const std::vector<std::string> lines = shown(seen.err), expected = shown(piped.err);
    ASSERT_EQ(lines.size(), expected.size()) << seen.err;
    for (std::size_t i = 0; i < lines.size(); ++i)
      EXPECT_EQ(without_measures(lines[i]), without_measures(expected[i]));
  }
}

/// One bar as it is drawn.
const std::regex kBar("\r\033\\[K(\\S+) +\\[(=*)( *)\\] +([0-9]+) %(?:, [0-9]+ (?:s|min) left)?");

TEST_F(Terminal, OneBarRunsThroughFiveStagesAndNeverBackwards) {
  const Ending seen = run(build("result"), true);
  ASSERT_EQ(seen.code, 0) << seen.err;
  std::vector<std::string> stages;
  int percent = 0, bars = 0;
  for (std::sregex_iterator it(seen.err.begin(), seen.err.end(), kBar), end; it != end; ++it) {
    ++bars;
    EXPECT_EQ((*it)[2].length() + (*it)[3].length(), 40) << it->str();
    EXPECT_LT(it->length(), 80 + 4) << it->str();
    if (stages.empty() || (*it)[1] != stages.back()) stages.push_back((*it)[1]);
    EXPECT_GE(std::stoi((*it)[4]), percent) << it->str();
    percent = std::stoi((*it)[4]);
    EXPECT_LE(percent, 100);
  }
  EXPECT_EQ(stages,
            (std::vector<std::string>{"Reading", "Terrain", "Buildings", "Meshing", "Writing"}));
  EXPECT_GT(bars, 20);
  EXPECT_GE(percent, 90);
}

TEST_F(Terminal, TellsTheTimeLeftOfLongRuns) {
  std::vector<std::string> arguments = build("result");
  arguments.back() = "1.2";  // metres: a second or more
  const Ending seen = run(arguments, true);
  ASSERT_EQ(seen.code, 0) << seen.err;
  EXPECT_NE(seen.err.find(" s left"), std::string::npos) << seen.err;
}

TEST_F(Terminal, BarsFitNarrowTerminalsAndDumbOnesHaveNone) {
  setenv("COLUMNS", "50", 1);
  const Ending narrow = run(build("result"), true);
  unsetenv("COLUMNS");
  int bars = 0;
  for (std::sregex_iterator it(narrow.err.begin(), narrow.err.end(), kBar), end; it != end; ++it) {
    ++bars;
    EXPECT_LT(it->length(), 50 + 4) << it->str();
  }
  EXPECT_GT(bars, 20);
  const char* kind = std::getenv("TERM");
  const std::string before = kind == nullptr ? "" : kind;
  setenv("TERM", "dumb", 1);
  const Ending dumb = run(build("result"), true);
  before.empty() ? unsetenv("TERM") : setenv("TERM", before.c_str(), 1);
  EXPECT_EQ(dumb.err.find('\033'), std::string::npos) << dumb.err;
  EXPECT_EQ(dumb.err.find('%', dumb.err.find("\nReading")), std::string::npos) << dumb.err;
}

TEST_F(Terminal, AnInterruptedRunLeavesItsLastLineByItself) {
  std::vector<std::string> arguments = build("result");
  arguments.back() = "1";  // metres: far from its end when the signal comes
  Process process = start(arguments, true);
  ASSERT_TRUE(testing::wait_for_staging(folder.path(), process));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  process.signal(SIGINT);
  const Ending ending = process.wait();
  ASSERT_EQ(ending.code, 130) << ending.err;
  const std::vector<std::string> lines = shown(ending.err);
  ASSERT_GE(lines.size(), 2U) << ending.err;
  EXPECT_EQ(lines.back(), "");
  EXPECT_EQ(lines[lines.size() - 2], "tetropolis: interrupted; nothing was written");
}

TEST_F(Terminal, QuietShowsNothing) {
  std::vector<std::string> arguments = build("result");
  arguments.emplace_back("--quiet");
  const Ending seen = run(arguments, true);
  EXPECT_EQ(seen.code, 0);
  EXPECT_EQ(seen.err, "");
}

}  // namespace
}  // namespace tetropolis
