#include <fmt/format.h>

#include <optional>

#include "commands.h"
#include "tetropolis/pipeline/check_results.h"

namespace tetropolis::app {

bool check(const std::string& path, double min_distance, Console& console) {
  Progress progress;
  progress.cancelled = interrupted;
  const auto files = check_path(
      path, min_distance < 0 ? std::nullopt : std::optional(min_distance), progress);
  std::int64_t violations = 0;
  for (const CheckedFile& file : files) {
    fmt::print("{}\n", file.name);
    for (const std::string& fact : file.facts) fmt::print("  {}\n", fact);
    for (const Violation& violation : file.violations) {
      fmt::print("  VIOLATED: {} ({}); first: {}\n", violation.what, violation.count, violation.first);
      ++violations;
    }
  }
  if (violations == 0)
    fmt::print("every guarantee holds\n");
  else
    console.error(fmt::format("tetropolis: {}: {} guarantee{} broken", path, violations, violations == 1 ? "" : "s"));
  return violations == 0;
}

}  // namespace tetropolis::app
