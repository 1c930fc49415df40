#include "building_names.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace tetropolis {

namespace {

constexpr std::size_t kLongestName = 32;  // in CGNS

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

}  // namespace

std::vector<std::string> plain_names(std::span<const Building> buildings) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (std::size_t b = 0; b < buildings.size(); ++b) {
    std::string name = buildings[b].id;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return !is_plain(c); }, '_');
    if (name.empty() || kPrefix + name.size() > kLongestName || !taken.insert(name).second) {
      const std::string number = fmt::format(".{}", b);  // no other name has a point
      name = name.substr(0, kLongestName - kPrefix - number.size()) + number;
    }
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace tetropolis
