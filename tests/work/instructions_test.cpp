// Instructions of every stage, counted by Valgrind: what the other counts do not see, such as a
// search that walks too far. Two limits each: the instructions on a city of 50 buildings (they
// differ a little between compilers), and how many times more a city of 200 takes (they hardly do,
// and more than 4 means that the stage is not linear).
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/sanitized.h"
#include "support/test_data.h"
#include "work_limits.h"

namespace tetropolis::testing {
namespace {

constexpr std::array kStages{"simplify", "crowd",   "ground",   "columns",
                             "uniform",  "quality", "boundary", "write"};

#if defined(__GNUC__) && defined(__x86_64__) && !defined(__clang__)
const bool kWideKernels = __builtin_cpu_supports("avx2");
#else
const bool kWideKernels = false;
#endif

/// Instructions below each call of a function work_* in a file of callgrind.
std::map<std::string, double> inclusive_costs(const std::string& path) {
  std::map<std::string, double> costs;
  std::ifstream file(path);
  std::string callee;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("cfn=")) callee = line.substr(4);
    if (!line.starts_with("calls=")) continue;
    std::getline(file, line);  // position and inclusive cost
    const std::string prefix = "tetropolis::testing::work_";
    if (callee.starts_with(prefix))
      costs[callee.substr(prefix.size(), callee.find('(') - prefix.size())] +=
          std::stod(line.substr(line.find(' ') + 1));
  }
  return costs;
}

std::map<std::string, double> count_instructions(int buildings) {
  const TemporaryFolder folder;
  const std::string counts = folder / "callgrind.out";
  const std::string command = fmt::format(
      "valgrind --tool=callgrind --compress-strings=no --compress-pos=no --callgrind-out-file={} "
      "{} {} {} >/dev/null 2>&1",
      counts, TETROPOLIS_RUN_STAGES, buildings, folder.path().string());
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return inclusive_costs(counts);
}

TEST(Instructions, OfEveryStage) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "sanitizers do not run under Valgrind";
  if (std::system("valgrind --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs valgrind (apt-get install valgrind)";
  const auto small = count_instructions(50);
  const auto large = count_instructions(200);
  for (const std::string stage : kStages) {
    ASSERT_TRUE(small.contains(stage) && large.contains(stage)) << stage;
    // The kernels of the solver come in two widths, and the limits are those of the wider.
    if (stage == "uniform" && !kWideKernels) continue;
    expect_work(stage + ".instructions", small.at(stage));
    expect_work(stage + ".instructions_growth", large.at(stage) / small.at(stage));
  }
}

}  // namespace
}  // namespace tetropolis::testing
