#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/case/wind.h"
#include "tetropolis/core/error.h"

namespace tetropolis {

namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = std::min(line.find(','), line.size());
    std::string_view cell = line.substr(0, comma);
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!cell.empty() && is_space(cell.front())) cell.remove_prefix(1);
    while (!cell.empty() && is_space(cell.back())) cell.remove_suffix(1);
    cells.push_back(cell);
    if (comma == line.size()) return cells;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

std::vector<WindLevel> read_wind_levels(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorKind::kInput, fmt::format("{}: cannot be read", path.string()));
  constexpr std::array<std::string_view, 3> kNames = {"height", "speed", "k"};
  std::array<std::size_t, 3> columns{};
  std::vector<WindLevel> levels;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto refuse = [&](const char* why) {
      throw Error(ErrorKind::kInput, fmt::format("{}: line {} {}", path.string(), number, why));
    };
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (number == 1) {
      for (std::size_t c = 0; c < kNames.size(); ++c) {
        const auto found = std::find(cells.begin(), cells.end(), kNames[c]);
        if (found == cells.end()) refuse("is no heading with height, speed and k");
        columns[c] = static_cast<std::size_t>(found - cells.begin());
      }
      continue;
    }
    std::array<double, 3> values{};
    for (std::size_t c = 0; c < values.size(); ++c) {
      const std::string_view cell = columns[c] < cells.size() ? cells[columns[c]] : "";
      const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), values[c]);
      if (read.ec != std::errc() || read.ptr != cell.data() + cell.size())
        refuse("has not a number each for height, speed and k");
    }
    levels.push_back({values[0], values[1], values[2]});
  }
  if (levels.empty())
    throw Error(ErrorKind::kInput, fmt::format("{}: has no levels", path.string()));
  return levels;
}

}  // namespace tetropolis
