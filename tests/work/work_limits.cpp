#include "work_limits.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tetropolis::testing {

namespace {

struct Limit {
  double measured = 0;
  double tolerance = 5;  ///< Per cent.
};

struct Limits {
  std::string comment;  ///< The lines that start with #.
  std::map<std::string, Limit> values;
};

Limits read_limits() {
  std::ifstream file(TETROPOLIS_WORK_LIMITS);
  if (!file) throw std::runtime_error("cannot read " TETROPOLIS_WORK_LIMITS);
  Limits limits;
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) continue;
    if (line[0] == '#') {
      limits.comment += line + "\n";
      continue;
    }
    std::istringstream words(line);
    std::string name;
    Limit limit;
    if (!(words >> name >> limit.measured >> limit.tolerance))
      throw std::runtime_error(TETROPOLIS_WORK_LIMITS ": cannot understand: " + line);
    limits.values[name] = limit;
  }
  return limits;
}

Limits& limits() {
  static Limits all = read_limits();
  return all;
}

bool updating() { return std::getenv("TETROPOLIS_UPDATE_WORK") != nullptr; }

/// Whole numbers as they are, others with four digits.
std::string number(double value) {
  return value == std::floor(value) ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
}

class WriteAtEnd : public ::testing::Environment {
 public:
  void TearDown() override {
    if (!updating()) return;
    std::ofstream file(TETROPOLIS_WORK_LIMITS);
    file << limits().comment;
    for (const auto& [name, limit] : limits().values)
      file << fmt::format("{:<32} {:>14} {:>4}\n", name, number(limit.measured),
                          number(limit.tolerance));
  }
};
const auto* const write_at_end = ::testing::AddGlobalTestEnvironment(new WriteAtEnd);

}  // namespace

void expect_work(const std::string& name, double value) {
  if (updating()) {
    limits().values[name].measured = value;
    return;
  }
  const auto found = limits().values.find(name);
  if (found == limits().values.end()) {
    ADD_FAILURE() << name << " = " << number(value)
                  << " has no limit; scripts/update-work-limits stores one";
    return;
  }
  const auto [measured, tolerance] = found->second;
  EXPECT_LE(value, measured * (1 + tolerance / 100))
      << name << " was " << number(measured) << " (tolerance " << tolerance
      << " %): the program does more work than it did. If that is meant, "
      << "scripts/update-work-limits stores the new count";
  if (value < measured * (1 - 2 * tolerance / 100))
    std::cout << "note: " << name << " fell from " << number(measured) << " to " << number(value)
              << "; scripts/update-work-limits keeps it there\n";
}

}  // namespace tetropolis::testing
