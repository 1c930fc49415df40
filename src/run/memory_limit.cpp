#include "memory_limit.h"

#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "tetropolis/core/error.h"

#include "pipeline/memory.h"

namespace tetropolis {

double parse_size(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (unit.ends_with('B') || unit.ends_with('b')) unit.remove_suffix(1);
  constexpr std::string_view units = "KMGTkmgt";
  double factor = 1;
  if (unit.size() == 1 && units.find(unit[0]) != std::string_view::npos)
    factor = std::pow(1000.0, static_cast<double>(units.find(unit[0]) % 4 + 1));
  else if (!unit.empty())
    factor = 0;
  if (error != std::errc() || !(number > 0) || !std::isfinite(number) || factor == 0)
    throw Error(ErrorKind::kUsage, "'" + text + "' is not a size; write for example 8G or 500M");
  constexpr double kLeast = 1e6;
  if (number * factor < kLeast)
    throw Error(ErrorKind::kUsage,
                "'" + text + "' is less than a megabyte; write for example 8G or 500M");
  return number * factor;
}

double memory_limit(const Config& config) {
  return memory_limit(config.max_memory.empty() ? 0 : parse_size(config.max_memory));
}

}  // namespace tetropolis
