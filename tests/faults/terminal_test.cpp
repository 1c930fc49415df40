// What a user sees on a terminal: a bar while a step runs, and nothing of it afterwards.
#include <algorithm>
#include <chrono>
#include <csignal>
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

/// With N for what is measured: seconds and megabytes.
std::string without_measures(const std::string& line) {
  return std::regex_replace(line, std::regex(" +[0-9.]+ (s|MB)"), " N $1");
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

TEST_F(Terminal, ShowsABarWhileAStepRunsAndLeavesTheLinesOfAPipe) {
  const Ending piped = run(build("result"));
  const Ending seen = run(build("result"), true);
  ASSERT_EQ(piped.code, 0) << piped.err;
  ASSERT_EQ(seen.code, 0) << seen.err;
  EXPECT_EQ(piped.err.find('\r'), std::string::npos);
  EXPECT_EQ(piped.err.find('%'), std::string::npos);
  EXPECT_GT(std::count(seen.err.begin(), seen.err.end(), '%'), 100);
  const std::vector<std::string> lines = shown(seen.err), expected = shown(piped.err);
  ASSERT_EQ(lines.size(), expected.size()) << seen.err;
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_EQ(without_measures(lines[i]), without_measures(expected[i]));
}

TEST_F(Terminal, BarsNeverRunBackwards) {
  const Ending seen = run(build("result"), true);
  ASSERT_EQ(seen.code, 0) << seen.err;
  const std::regex bar("\r\033\\[K([^\\[]*)\\[(=*)( *)\\] +([0-9]+) %");
  std::string step;
  int percent = 0, bars = 0;
  for (std::sregex_iterator it(seen.err.begin(), seen.err.end(), bar), end; it != end; ++it) {
    ++bars;
    EXPECT_EQ((*it)[2].length() + (*it)[3].length(), 30) << it->str();
    if ((*it)[1] != step) percent = 0;
    step = (*it)[1];
    EXPECT_GE(std::stoi((*it)[4]), percent) << step;
    percent = std::stoi((*it)[4]);
    EXPECT_LE(percent, 100);
  }
  EXPECT_GT(bars, 100);
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
